// Reads a recording with the libraries of others, and decodes every sample by the schemas in the file:
//
//     mkdir x; cd x; npm init -y; npm install @mcap/core @foxglove/omgidl-parser @foxglove/omgidl-serialization fzstd
//     cp .../read_with_mcap_core.mjs . && node read_with_mcap_core.mjs FILE.mcap
//
// Prints the number of messages of each topic. Exit code 1 if one cannot be read or decoded, if they are out of order, or if reading the
// file from its start gives another number than reading it by its index.
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { parseIDL } from "@foxglove/omgidl-parser";
import { MessageReader } from "@foxglove/omgidl-serialization";
import * as fzstd from "fzstd";
import fs from "node:fs/promises";

const data = await fs.readFile(process.argv[2]);
const decompressHandlers = { zstd: (bytes, size) => fzstd.decompress(bytes, new Uint8Array(Number(size))) };
const readable = {
  size: async () => BigInt(data.length),
  read: async (offset, length) => data.subarray(Number(offset), Number(offset + length)),
};
const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });

const decoders = new Map();
function decode(channel, bytes) {
  if (channel.messageEncoding === "json") return JSON.parse(new TextDecoder().decode(bytes));
  const schema = reader.schemasById.get(channel.schemaId);
  if (!decoders.has(schema.name)) {
    decoders.set(schema.name, new MessageReader(schema.name, parseIDL(new TextDecoder().decode(schema.data))));
  }
  return decoders.get(schema.name).readMessage(bytes);
}

const counts = {};
let numIndexed = 0, last = 0n, isOrdered = true;
for await (const message of reader.readMessages()) {
  const channel = reader.channelsById.get(message.channelId);
  decode(channel, message.data);
  isOrdered = isOrdered && message.logTime >= last;
  last = message.logTime;
  counts[channel.topic] = (counts[channel.topic] ?? 0) + 1;
  ++numIndexed;
}

let numStreamed = 0;
const stream = new McapStreamReader({ decompressHandlers, validateCrcs: true });
stream.append(data);
for (let record; (record = stream.nextRecord()); ) numStreamed += record.type === "Message" ? 1 : 0;

console.log(counts);
const isRight = isOrdered && stream.done() && numStreamed === numIndexed && numIndexed === Number(reader.statistics.messageCount);
console.log(`${numIndexed} messages, ${decoders.size} types decoded: ${isRight ? "all right" : "NOT RIGHT"}`);
process.exit(isRight ? 0 : 1);
