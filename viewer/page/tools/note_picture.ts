// SPDX-License-Identifier: MIT
// A picture as a note holds it: within the note, small, and without what cameras write beside it (where it was taken).

const LONGEST_SIDE = 1280; // pixels
const QUALITY = 0.82;

function drawn(picture: ImageBitmap): HTMLCanvasElement {
  const scale = Math.min(1, LONGEST_SIDE / Math.max(picture.width, picture.height));
  const canvas = document.createElement('canvas');
  canvas.width = Math.max(1, Math.round(picture.width * scale));
  canvas.height = Math.max(1, Math.round(picture.height * scale));
  const context = canvas.getContext('2d')!;
  context.imageSmoothingQuality = 'high';
  context.drawImage(picture, 0, 0, canvas.width, canvas.height);
  return canvas;
}

/// As `data:image/…`. Browsers that cannot write WebP write JPEG. Rejects what is no picture.
export async function notePicture(file: Blob): Promise<string> {
  const picture = await createImageBitmap(file);
  try {
    const canvas = drawn(picture);
    const made = canvas.toDataURL('image/webp', QUALITY);
    return made.startsWith('data:image/webp') ? made : canvas.toDataURL('image/jpeg', QUALITY);
  } finally {
    picture.close();
  }
}
