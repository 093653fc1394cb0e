import { readFileSync } from "node:fs";
import * as kernels from "./kernels.mjs";

const [name, time, ...sizes] = process.argv.slice(2);
const numbers = new Float64Array(Uint8Array.from(readFileSync(0)).buffer);
const count = sizes.reduce((sum, size) => sum + Number(size), 0);
const results = [];
for (let start = 0; start < Math.max(numbers.length, 1); start += Math.max(count, 1)) {
  let place = start;
  const vectors = sizes.map((size) => numbers.subarray(place, (place += Number(size))));
  if (time) vectors[time] = vectors[time][0]; // a number
  results.push(kernels[name](...vectors));
}
const shape = (value) => (Array.isArray(value) ? [value.length, ...shape(value[0])] : []);
const plain = (value) => (ArrayBuffer.isView(value) ? Array.from(value) : value);
process.stdout.write(JSON.stringify(shape(plain(results[0]))) + "\n");
const flat = results.map(plain).flat(3);
process.stdout.write(new Uint8Array(Float64Array.from(flat).buffer));
