const element = (id) => document.getElementById(id);

/** Bytes of base64 text that were deflated. */
async function inflated(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Columns of a table that viewer/web/columns.py packed: {name: Int32Array}. */
async function unpacked(table) {
  const bytes = await inflated(table.data);
  const columns = {};
  let start = 0;
  for (const { name, bytes: width } of table.columns) {
    columns[name] = summed(bytes.subarray(start, start + width * table.count), table.count, width);
    start += width * table.count;
  }
  return columns;
}

function summed(planes, count, width) {
  const values = new Int32Array(count);
  let before = 0;
  for (let i = 0; i < count; i++) {
    let zigzag = 0;
    for (let k = 0; k < width; k++) zigzag |= planes[k * count + i] << (8 * k);
    before += (zigzag >>> 1) ^ -(zigzag & 1);
    values[i] = before;
  }
  return values;
}

/** The number that a rounded code stands for; 0 stands for none. */
const unrounded = (code, { step, start }) => (code === 0 ? NaN : (start + code - 1) * step);

/** The number that a logarithmic code stands for; 0 stands for less than the least. */
const unlogged = (code, { least, ratio }) => (code === 0 ? 0 : least * ratio ** (code - 1));
