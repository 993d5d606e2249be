import assert from "node:assert/strict";
import { test } from "node:test";
import { ReconnectingSocket } from "../../clients/web/reconnecting_socket.js";

/** A browser's WebSocket, which connects when it is told to and warns of a close before. */
class Connection {
  static CONNECTING = 0;
  static OPEN = 1;
  static CLOSING = 2;
  static made = [];
  readyState = Connection.CONNECTING;
  warnings = 0;

  constructor() {
    Connection.made.push(this);
  }

  connect() {
    this.readyState = Connection.OPEN;
    this.onopen();
  }

  close() {
    if (this.readyState === Connection.CONNECTING) this.warnings += 1;
    this.readyState = Connection.CLOSING;
  }
}

/** A socket that has begun to connect, and how often it said that it is open. */
function connecting() {
  Object.assign(globalThis, { WebSocket: Connection, location: { href: "http://127.0.0.1:8000/" } });
  const said = { opened: 0 };
  const socket = new ReconnectingSocket("joints", {
    onMessage: () => {},
    onOpen: () => {
      said.opened += 1;
    },
  });
  socket.open();
  return { socket, connection: Connection.made.at(-1), said };
}

test("a connection that is closed before it is open ends as soon as it is open, without a warning or a word", () => {
  const { socket, connection, said } = connecting();
  socket.close();
  assert.equal(connection.readyState, Connection.CONNECTING);
  connection.connect();
  assert.equal(connection.readyState, Connection.CLOSING);
  assert.deepEqual([connection.warnings, said.opened], [0, 0]);
});

test("an open connection is closed at once", () => {
  const { socket, connection, said } = connecting();
  connection.connect();
  socket.close();
  assert.deepEqual([connection.readyState, said.opened], [Connection.CLOSING, 1]);
});
