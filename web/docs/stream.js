/** The AsyncAPI document as text and tables: the messages on the WebSocket. */

import { el } from "/web/js/base/dom.js";

const DIRECTIONS = { send: "to the client", receive: "from the client" };

/** Fetch the document and show it in `section`, or an error message. */
export async function showStream(section) {
  try {
    const answer = await fetch("/asyncapi.json");
    if (!answer.ok) throw new Error(`status ${answer.status}`);
    section.append(...streamParts(await answer.json()));
  } catch (error) {
    section.append(el("p", { role: "alert" }, `Cannot show the stream: ${error.message}`));
  }
}

function streamParts(described) {
  const channel = described.channels.stream;
  const query = channel.bindings.ws.query.properties;
  const operations = Object.values(described.operations);
  return [
    el("h2", { id: "stream-title" }, `The stream: WS ${channel.address}`),
    ...blocks(described.info.description),
    el("h3", {}, "Query parameters"),
    table(Object.entries(query).map(([name, schema]) => row(name, schema, described, false))),
    ...operations.flatMap((operation) =>
      operation.messages.flatMap((message) =>
        messageParts(found(described, found(described, message)), operation, described),
      ),
    ),
  ];
}

function messageParts(message, operation, described) {
  const schema = found(described, message.payload);
  const required = new Set(schema.required ?? []);
  return [
    el("h3", {}, el("code", {}, message.name), ` ${DIRECTIONS[operation.action]}`),
    el("p", {}, ...inline(message.summary)),
    table(
      Object.entries(schema.properties).map(([name, member]) =>
        row(name, member, described, required.has(name)),
      ),
    ),
    ...message.examples.map((example) =>
      el(
        "details",
        {},
        el("summary", {}, `Example: ${example.summary}`),
        el("pre", { tabindex: "0" }, JSON.stringify(example.payload, null, 2)),
      ),
    ),
  ];
}

/** Show paragraphs and lists of Markdown. */
function blocks(text) {
  return text.split("\n\n").map((block) => {
    if (!block.startsWith("* ")) return el("p", {}, ...inline(block));
    const items = block.split("\n").map((line) => el("li", {}, ...inline(line.slice(2))));
    return el("ul", {}, ...items);
  });
}

/** Show `code` and [words](address) of Markdown. */
function inline(text) {
  return text.split(/(`[^`]+`|\[[^\]]+\]\([^)]+\))/).map((piece) => {
    const link = /^\[([^\]]+)\]\((\/[^)]*)\)$/.exec(piece);
    if (link) return el("a", { href: link[2] }, link[1]);
    return piece.startsWith("`") ? el("code", {}, piece.slice(1, -1)) : piece;
  });
}

function table(rows) {
  return el("table", {}, el("tbody", {}, ...rows));
}

function row(name, schema, described, required) {
  return el(
    "tr",
    {},
    el("th", { scope: "row" }, el("code", {}, name)),
    el("td", { class: "quiet" }, typeOf(schema, described), required ? null : ", optional"),
    el("td", {}, ...inline(schema.description ?? "")),
  );
}

/** Describe the type of a value briefly. */
function typeOf(schema, described) {
  if (schema.$ref) return typeOf(found(described, schema), described);
  if (schema.const !== undefined) return JSON.stringify(schema.const);
  if (schema.enum) return schema.enum.join(" | ");
  if (schema.anyOf) return schema.anyOf.map((kind) => typeOf(kind, described)).join(" | ");
  if (schema.type === "array" && schema.items) return `list of ${typeOf(schema.items, described)}`;
  return schema.format ?? schema.type ?? "anything";
}

/** Follow a reference inside the document. */
function found(described, { $ref: reference }) {
  return reference.slice(2).split("/").reduce((value, key) => value[key], described);
}
