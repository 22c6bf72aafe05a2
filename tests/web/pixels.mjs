// Reads pictures. A picture: {covered, width}, where `covered[i]` says whether something is drawn
// at pixel i.

/// Whether all pixels within `reach` of pixel `i` are covered.
export function coveredAround({ covered, width }, i, reach) {
  const height = covered.length / width;
  const [x, y] = [i % width, Math.floor(i / width)];
  for (let v = Math.max(0, y - reach); v <= Math.min(height - 1, y + reach); ++v) {
    for (let u = Math.max(0, x - reach); u <= Math.min(width - 1, x + reach); ++u) {
      if (!covered[v * width + u]) return false;
    }
  }
  return true;
}

/// The pixels of a canvas, RGBA, the lowest row first.
export function pixelsOf(canvas) {
  const gl = canvas.getContext('webgl2') ?? canvas.getContext('webgl');
  const pixels = new Uint8Array(canvas.width * canvas.height * 4);
  gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  return pixels;
}

/// Tells what stands in a picture, its lowest row first: how much of it is in the lower and in the upper
/// half of the rows it takes, and its mean colour.
export function standing({ covered, width }, pixels) {
  const places = [...covered.keys()].filter((i) => covered[i]);
  const middle = (Math.floor(places.at(0) / width) + Math.floor(places.at(-1) / width)) / 2;
  const upper = places.filter((i) => Math.floor(i / width) > middle).length;
  const mean = (channel) => places.reduce((sum, i) => sum + pixels[4 * i + channel], 0) / places.length;
  return { lower: places.length - upper, upper, colour: [mean(0), mean(1), mean(2)] };
}

/// Two pictures of one view, RGBA: the peak signal-to-noise ratio in decibels over pixels that both cover, and how many one of them
/// covers alone, in parts of those.
export function signalToNoise([one, other], [coveredByOne, coveredByOther]) {
  let both = 0;
  let alone = 0;
  let squares = 0;
  for (let i = 0; i < coveredByOne.length; ++i) {
    if (!coveredByOne[i] !== !coveredByOther[i]) ++alone;
    if (!coveredByOne[i] || !coveredByOther[i]) continue;
    ++both;
    for (let k = 4 * i; k < 4 * i + 3; ++k) squares += (one[k] - other[k]) ** 2;
  }
  return { covered: both, outline: alone / both, decibels: 10 * Math.log10((3 * both * 255 ** 2) / squares) };
}
