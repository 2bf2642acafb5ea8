"""A WebSocket client (RFC 6455) of texts."""
import base64
import json
import os
import socket
import struct


class WebSocket:
    def __init__(self, port, origin=None, path="/", host="localhost", token=None):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=20)
        key = base64.b64encode(os.urandom(16)).decode()
        lines = [f"GET {path} HTTP/1.1", f"Host: {host}:{port}", "Upgrade: websocket", "Connection: Upgrade",
                 f"Sec-WebSocket-Key: {key}", "Sec-WebSocket-Version: 13"]
        if origin:
            lines.append(f"Origin: {origin}")
        if token:
            lines.append(f"Authorization: Bearer {token}")
        self.socket.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
        answer = b""
        while b"\r\n\r\n" not in answer:
            answer += self.take(1)
        self.status = int(answer.split(b" ")[1])
        if self.status != 101:  # refused
            self.close()

    def take(self, count):
        data = b""
        while len(data) < count:
            part = self.socket.recv(count - len(data))
            if not part:
                raise ConnectionError("ended")
            data += part
        return data

    def send(self, message, opcode=1):
        data = message if isinstance(message, bytes) else json.dumps(message).encode()
        size = struct.pack("!B", 0x80 | len(data)) if len(data) < 126 else struct.pack("!BH", 0xFE, len(data))
        self.socket.sendall(bytes([0x80 | opcode]) + size + bytes(4) + data)  # a mask of zeros

    def receive(self):
        return json.loads(self.receive_text())

    def receive_text(self):
        """The next text. Answers pings, omits binary messages."""
        while True:
            opcode, data = self.receive_frame()
            if opcode == 9:
                self.send(data, opcode=10)
            elif opcode == 8:
                raise ConnectionError("closed")
            elif opcode == 1:
                return data

    def receive_frame(self):
        """(opcode, data)"""
        head = self.take(2)
        size = head[1] & 0x7F
        if size > 125:
            size, = struct.unpack(*(("!H", self.take(2)) if size == 126 else ("!Q", self.take(8))))
        return head[0] & 0xF, self.take(size)

    def end(self):
        """Also of a thread that waits for a message, whose wait ends."""
        self.socket.shutdown(socket.SHUT_RDWR)
        self.socket.close()

    def close(self):
        self.socket.close()
