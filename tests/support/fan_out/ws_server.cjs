// Frames to all clients by ws, as its documentation broadcasts. The last argument is their size.

const { WebSocket, WebSocketServer } = require("ws");

const PERIOD_MS = 50;
const size = Number(process.argv.at(-1));
const server = new WebSocketServer({ host: "127.0.0.1", port: 0 });

function frame(number) {
  const at = new Date().toISOString();
  const text = `{"type":"state","seq":${number},"at":"${at}","skipped":0,"filling":"`;
  return `${text}${"x".repeat(size - text.length - 2)}"}`;
}

function sendToAll(number) {
  const data = frame(number);
  for (const client of server.clients) {
    if (client.readyState === WebSocket.OPEN) client.send(data);
  }
}

server.on("listening", () => {
  console.log(`page  http://127.0.0.1:${server.address().port}/\nCtrl-C`);
  const begin = performance.now();
  let number = 0;
  const tick = () => {
    number += 1;
    sendToAll(number);
    setTimeout(tick, Math.max(0, begin + number * PERIOD_MS - performance.now()));
  };
  tick();
});
