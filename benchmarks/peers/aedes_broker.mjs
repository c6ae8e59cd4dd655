// aedes with an access list: it ends the connection of who publishes about FIC101. Publishes two loops itself.
// A line on stdin starts it anew, without anything kept; a line on stdout for each alarm published.
import net from "node:net";
import { Aedes } from "aedes";

let broker, server, sockets;

async function start(port) {
  broker = await Aedes.createBroker();
  broker.authorizePublish = (client, packet, done) =>
    done(client && packet.topic.startsWith("slipjump/FIC101/") ? new Error("not allowed") : null);
  broker.on("publish", (packet, client) => {
    if (client) console.log(JSON.stringify({ topic: packet.topic, retain: packet.retain, id: id(packet) }));
  });
  sockets = new Set();
  server = net.createServer((socket) => {
    sockets.add(socket);
    socket.on("close", () => sockets.delete(socket));
    broker.handle(socket);
  });
  await new Promise((listening) => server.listen(port, "127.0.0.1", listening));
  return server.address().port;
}

function id(packet) {
  try { return JSON.parse(packet.payload.toString()).message_id; } catch { return null; }
}

async function stop() {
  for (const socket of sockets) socket.destroy();
  await new Promise((closed) => server.close(closed));
  await new Promise((closed) => broker.close(closed));
}

const port = await start(0);
console.log(JSON.stringify({ port }));
setInterval(() => {
  const t = Date.now() / 1000;
  for (const loop of ["FIC101", "FIC102"]) {
    const payload = JSON.stringify({ t, pv: 50 + 5 * Math.sin(t), op: 50 - 5 * Math.cos(t) });
    broker.publish({ cmd: "publish", topic: `plant/${loop}`, payload, qos: 0, retain: false }, () => {});
  }
}, 50);
process.stdin.on("data", async () => {
  await stop();
  await start(port);
  console.log(JSON.stringify({ again: true }));
});
