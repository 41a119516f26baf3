/** /docs: the OpenAPI document by Swagger UI, and below it the stream, which it does not know. */

import { showStream } from "/web/docs/stream.js";

window.SwaggerUIBundle({
  url: "/openapi.json",
  domNode: document.getElementById("requests"),
  // Else it sends the address of the document to a service elsewhere.
  validatorUrl: null,
  docExpansion: "list",
  defaultModelsExpandDepth: -1,
  displayRequestDuration: true,
  syntaxHighlight: { activated: false },
});

await showStream(document.getElementById("stream"));
