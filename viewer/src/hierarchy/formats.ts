// SPDX-License-Identifier: MIT
// The formats of meshes and pictures. scripts/references writes this file.
export const FORMATS = {
  "meshes": [
    ".ply",
    ".obj",
    ".gltf",
    ".glb",
    ".stl",
    ".off",
    ".3tz",
    ".osgb",
    ".tif",
    ".tiff",
    ".hgt",
    ".asc"
  ],
  "namesOthers": [
    ".obj",
    ".gltf",
    ".tif",
    ".asc"
  ],
  "companions": [
    ".mtl",
    ".bin",
    ".tfw",
    ".tifw",
    ".wld",
    ".prj",
    ".jpg",
    ".jpeg",
    ".png",
    ".webp",
    ".ktx2",
    ".tif",
    ".tiff",
    ".bmp",
    ".gif",
    ".tga",
    ".dds"
  ],
  "pictures": [
    {
      "name": "jpeg",
      "title": "JPEG",
      "type": "image/jpeg"
    },
    {
      "name": "png",
      "title": "PNG",
      "type": "image/png"
    },
    {
      "name": "webp",
      "title": "WebP",
      "type": "image/webp"
    },
    {
      "name": "ktx2",
      "title": "KTX2",
      "type": "image/ktx2"
    }
  ],
  "browserPictures": [
    "image/jpeg",
    "image/png",
    "image/webp",
    "image/gif",
    "image/avif"
  ]
} as const;
