// Reads a run file with the public @mcap/core, as a stream (what a killed recorder leaves) and, when the file
// is complete, by its index. Prints {topic: [stream, index]}: messages of each topic, all of them valid JSON.
const fs = require("fs");
const { McapStreamReader, McapIndexedReader } = require("@mcap/core");

async function main(path) {
  const bytes = fs.readFileSync(path);
  const counts = {}, channels = new Map(), schemas = new Map();
  const count = (topic, how, data) => {
    JSON.parse(Buffer.from(data).toString("utf8"));
    (counts[topic] ??= [0, 0])[how] += 1;
  };
  const stream = new McapStreamReader();
  stream.append(bytes);
  for (let record; (record = stream.nextRecord()); ) {
    if (record.type === "Schema") schemas.set(record.id, JSON.parse(Buffer.from(record.data).toString("utf8")));
    if (record.type === "Channel") channels.set(record.id, record);
    if (record.type !== "Message") continue;
    const channel = channels.get(record.channelId);
    count(channel.topic, 0, record.data);
    const message = JSON.parse(Buffer.from(record.data).toString("utf8"));
    for (const field of schemas.get(channel.schemaId).required ?? [])
      if (!(field in message)) throw new Error(`${channel.topic}: ${field} is in the schema, not in the message`);
  }
  if (stream.done()) {
    const readable = {
      size: async () => BigInt(bytes.length),
      read: async (offset, size) => new Uint8Array(bytes.buffer, bytes.byteOffset + Number(offset), Number(size)),
    };
    const reader = await McapIndexedReader.Initialize({ readable });
    for await (const message of reader.readMessages())
      count(reader.channelsById.get(message.channelId).topic, 1, message.data);
  }
  console.log(JSON.stringify(counts));
}

main(process.argv[2]).catch((error) => { console.error(error); process.exit(1); });
