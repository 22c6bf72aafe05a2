// SPDX-License-Identifier: MIT
import { readdirSync, readFileSync } from 'node:fs';
import path from 'node:path';
import { describe, expect, it } from 'vitest';

/// Each module with those that it names in `import` and `export … from`, types too, and in `import()`.
type Imports = ReadonlyMap<string, readonly string[]>;

const NAMED = /(?:^|\n)(?:import|export)\b[^;'"]*?from '(\.[^']*)'|(?:^|\n)import '(\.[^']*)'|\bimport\('(\.[^']*)'\)/g;

function importsOf(file: string): string[] {
  return [...readFileSync(file, 'utf8').matchAll(NAMED)].map(([, from, effect, lazy]) => path.join(path.dirname(file), (from ?? effect ?? lazy).replace(/\.js$/, '.ts')));
}

function modulesOf(...folders: string[]): Imports {
  const files = folders.flatMap((folder) => readdirSync(folder, { recursive: true, encoding: 'utf8' }).map((file) => path.join(folder, file)));
  return new Map(files.filter((file) => file.endsWith('.ts')).map((file) => [file, importsOf(file)]));
}

/// Each circle once, as the modules along it. O(modules + imports).
function circlesIn(imports: Imports): string[][] {
  const circles: string[][] = [];
  const way: string[] = [];
  const done = new Set<string>();
  const visit = (file: string): void => {
    if (way.includes(file)) circles.push([...way.slice(way.indexOf(file)), file]);
    if (way.includes(file) || done.has(file)) return;
    way.push(file);
    for (const next of imports.get(file) ?? []) visit(next);
    way.pop();
    done.add(file);
  };
  for (const file of imports.keys()) visit(file);
  return circles;
}

describe('imports', () => {
  const modules = modulesOf('src', 'page');

  it('make no circle', () => {
    expect(modules.size).toBeGreaterThan(200);
    expect(circlesIn(modules)).toEqual([]);
  });

  it('are seen in all their forms', () => {
    expect(modules.get(path.join('src', 'element', 'index.ts'))).toEqual([path.join('src', 'element', 'viewer_element.ts'), path.join('src', 'element', 'viewer_element.ts')]);
    expect(modules.get(path.join('page', 'view', 'extensions.ts'))).toContain(path.join('src', 'plugins', 'immersion.ts'));
  });

  it('would be told of a circle', () => {
    expect(circlesIn(new Map([['a', ['b']], ['b', ['c', 'd']], ['c', []], ['d', ['a']]]))).toEqual([['a', 'b', 'd', 'a']]);
  });

  it('lead from the page to the library, never back', () => {
    const back = [...modules].filter(([file, named]) => file.startsWith('src') && named.some((other) => other.startsWith('page')));
    expect(back.map(([file]) => file)).toEqual([]);
  });
});
