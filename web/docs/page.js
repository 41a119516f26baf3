/** /docs: the OpenAPI document in Swagger UI, and below it the stream, which it does not cover. */

import { showStream } from "/web/docs/stream.js";

window.SwaggerUIBundle({
  url: "/openapi.json",
  domNode: document.getElementById("requests"),
  // By default Swagger UI sends the address of the document to an external validator.
  validatorUrl: null,
  docExpansion: "list",
  defaultModelsExpandDepth: -1,
  displayRequestDuration: true,
  syntaxHighlight: { activated: false },
});

await showStream(document.getElementById("stream"));
