// The WebSocket to the server. A lost connection is retried until it succeeds.

import type { Command, Frame, Hello } from './messages';

export interface Listener {
  hello(hello: Hello): void;
  frame(frame: Frame): void;
  refused(why: string): void;
  connected(is: boolean): void;
}

const FIRST_WAIT_MS = 250;
const LONGEST_WAIT_MS = 2000;

export class Connection {
  private socket: WebSocket | undefined;
  private wait_ms = FIRST_WAIT_MS;

  constructor(private readonly listener: Listener) {
    this.open();
  }

  /** Returns false without a connection; the command is then dropped. */
  send(command: Command): boolean {
    if (this.socket?.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(command));
    return true;
  }

  private open(): void {
    const socket = new WebSocket(`ws://${location.host}/live`);
    socket.onopen = () => {
      this.wait_ms = FIRST_WAIT_MS;
      this.listener.connected(true);
    };
    socket.onmessage = (event) => this.receive(JSON.parse(event.data as string));
    socket.onclose = () => {
      this.listener.connected(false);
      setTimeout(() => this.open(), this.wait_ms);
      this.wait_ms = Math.min(2 * this.wait_ms, LONGEST_WAIT_MS);
    };
    this.socket = socket;
  }

  private receive(message: Hello | Frame | { type: 'refused'; why: string }): void {
    if (message.type === 'hello') this.listener.hello(message);
    else if (message.type === 'frame') this.listener.frame(message);
    else this.listener.refused(message.why);
  }
}
