// SPDX-License-Identifier: MIT
// The files that a visitor has chosen or dropped, those in folders too.
import type { Chosen } from './plan.js';

const MOST_FILES = 10_000;

function fileOf(entry: FileSystemFileEntry): Promise<File> {
  return new Promise((resolve, reject) => { entry.file(resolve, reject); });
}

/// A reader gives a hundred at a time, and none in the end.
async function childrenOf(entry: FileSystemDirectoryEntry): Promise<FileSystemEntry[]> {
  const reader = entry.createReader();
  const all: FileSystemEntry[] = [];
  for (;;) {
    const some = await new Promise<FileSystemEntry[]>((resolve, reject) => { reader.readEntries(resolve, reject); });
    if (some.length === 0 || all.length > MOST_FILES) return all;
    all.push(...some);
  }
}

async function collect(entry: FileSystemEntry, folder: string, found: Chosen[]): Promise<void> {
  if (found.length >= MOST_FILES) return;
  const path = folder + entry.name;
  if (entry.isFile) found.push({ file: await fileOf(entry as FileSystemFileEntry), path });
  else for (const child of await childrenOf(entry as FileSystemDirectoryEntry)) await collect(child, `${path}/`, found);
}

/// Lists the files of a drop. They must be asked for at once: they are gone when the event is.
export async function droppedFiles({ items, files }: DataTransfer): Promise<Chosen[]> {
  const entries = [...items].map((item) => item.webkitGetAsEntry()).filter((entry) => entry !== null);
  if (entries.length === 0) return listedFiles(files);
  const found: Chosen[] = [];
  for (const entry of entries) await collect(entry, '', found);
  return found;
}

export function listedFiles(files: FileList): Chosen[] {
  return [...files].map((file) => ({ file, path: file.webkitRelativePath || file.name }));
}
