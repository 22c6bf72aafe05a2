// SPDX-License-Identifier: MIT
// Sorts files that were dropped or chosen: which are meshes, and which belong to which of them.
import { FORMATS } from '../../src/hierarchy/formats.js';
import { words } from '../words/words.js';

export interface Chosen {
  file: File;
  /// Relative to what was dropped: "house/textures/wall.png".
  path: string;
}

/// One request: a mesh file, or the files of one model, which lie beside each other in the end.
export interface Upload {
  /// In the inbox: "scan.ply", "house".
  name: string;
  files: readonly { name: string; file: File }[];
  isFolder: boolean;
  bytes: number;
}

export interface Plan {
  uploads: Upload[];
  /// One line each.
  problems: string[];
}

/// Matches names that have one of the endings, perhaps with ".gz" behind it; the name before that is the first group.
function namesEndingIn(endings: readonly string[]): RegExp {
  return new RegExp(`^(.+)(?:${endings.map((ending) => ending.replace('.', '\\.')).join('|')})(?:\\.gz)?$`, 'i');
}

const MESH = namesEndingIn(FORMATS.meshes);
/// Other files that are chosen with several meshes belong to the only one of these.
const NAMES_OTHERS = namesEndingIn(FORMATS.namesOthers);
const COMPANION = namesEndingIn(FORMATS.companions);

/// Folder, with a slash at its end, and name.
function split(path: string): [string, string] {
  const end = path.lastIndexOf('/') + 1;
  return [path.slice(0, end), path.slice(end)];
}

function isHidden(path: string): boolean {
  return path.split('/').some((part) => part.startsWith('.') || part === '__MACOSX');
}

function isMesh({ path }: Chosen): boolean {
  return MESH.test(split(path)[1]);
}

function isCompanion({ path }: Chosen): boolean {
  return COMPANION.test(split(path)[1]);
}

/// What may be a mesh or a picture of one (a TIFF may hold heights) is a mesh where there is no other.
function meshesAmong(files: readonly Chosen[]): readonly Chosen[] {
  const meshes = files.filter(isMesh);
  const sure = meshes.filter((file) => !isCompanion(file));
  return sure.length > 0 ? sure : meshes;
}

/// The nearest meshes: those in the folder of a file, or in the next one above that has some; all if none has.
function meshesFor({ path }: Chosen, meshes: readonly Chosen[]): readonly Chosen[] {
  for (let [folder] = split(path); folder !== ''; [folder] = split(folder.slice(0, -1))) {
    const near = meshes.filter((mesh) => split(mesh.path)[0] === folder);
    if (near.length > 0) return near;
  }
  const beside = meshes.filter((mesh) => split(mesh.path)[0] === '');
  return beside.length > 0 ? beside : meshes;
}

/// The one that a file belongs to; null if that cannot be told.
function ownerOf(file: Chosen, meshes: readonly Chosen[]): Chosen | null {
  const near = meshesFor(file, meshes);
  const likely = near.filter(({ path }) => NAMES_OTHERS.test(path));
  if (near.length === 1) return near[0];
  return likely.length === 1 ? likely[0] : null;
}

function uploadOf(mesh: Chosen, companions: readonly Chosen[]): Upload {
  const files = [mesh, ...companions].map(({ file, path }) => ({ name: split(path)[1], file }));
  const bytes = files.reduce((sum, { file }) => sum + file.size, 0);
  const [{ name }] = files;
  const isFolder = companions.length > 0;
  return { name: isFolder ? MESH.exec(name)![1] : name, files, isFolder, bytes };
}

/// As a disk that takes small and capital letters for the same sees them.
function repeatedName({ files }: Upload): string | null {
  const names = files.map(({ name }) => name.toLowerCase());
  return files.find((_, i) => names.indexOf(names[i]) !== i)?.name ?? null;
}

/// `limit`: the most bytes of one upload.
function problemOf(upload: Upload, limit: number, limitText: string): string | null {
  const repeated = repeatedName(upload);
  if (repeated !== null) return words.upload.sameName(upload.name, repeated);
  return upload.bytes > limit ? words.upload.tooLarge(upload.name, limitText) : null;
}

export function plan(chosen: readonly Chosen[], limit: number, limitText: string): Plan {
  const visible = chosen.filter(({ path }) => !isHidden(path));
  const meshes = meshesAmong(visible);
  if (meshes.length === 0) return { uploads: [], problems: [words.upload.noMesh(FORMATS.meshes.join(', '))] };
  const belonging = new Map<Chosen, Chosen[]>(meshes.map((mesh) => [mesh, []]));
  for (const file of visible.filter((file) => isCompanion(file) && !meshes.includes(file))) {
    const owner = ownerOf(file, meshes);
    if (owner === null) return { uploads: [], problems: [words.upload.whose(split(file.path)[1])] };
    belonging.get(owner)!.push(file);
  }
  const uploads = [...belonging].map(([mesh, companions]) => uploadOf(mesh, companions));
  const problems = uploads.map((upload) => problemOf(upload, limit, limitText));
  return { uploads: uploads.filter((_, i) => problems[i] === null), problems: problems.filter((problem) => problem !== null) };
}
