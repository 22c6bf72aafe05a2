// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { plan, type Chosen } from '../../page/upload/plan.js';

function chosen(path: string, bytes = 1): Chosen {
  return { file: new File(['x'.repeat(bytes)], path.replace(/^.*\//, '')), path };
}

/// Each upload as its name, "/" if it is a folder, and its files.
function planned(...paths: string[]): string[] {
  const { uploads, problems } = plan(paths.map((path) => chosen(path)), 1000, '1 kB');
  return [...uploads.map(({ name, isFolder, files }) => `${name}${isFolder ? '/' : ''}: ${files.map((file) => file.name).join(' ')}`), ...problems];
}

describe('files that are dropped', () => {
  it.each([
    [['scan.ply'], ['scan.ply: scan.ply']],
    [['a.ply', 'b.STL.gz'], ['a.ply: a.ply', 'b.STL.gz: b.STL.gz']],
    [['house.obj', 'house.mtl', 'wall.PNG'], ['house/: house.obj house.mtl wall.PNG']],
    [['scene.gltf', 'scene.bin', 'notes.txt'], ['scene/: scene.gltf scene.bin']],
    [['house.obj', 'notes.txt'], ['house.obj: house.obj']],
    [['house.obj', 'house.mtl', 'scan.ply'], ['house/: house.obj house.mtl', 'scan.ply: scan.ply']],
  ])('%j become %j', (paths, uploads) => { expect(planned(...paths)).toEqual(uploads); });

  it('in folders belong to the mesh that is nearest', () => {
    expect(planned('all/a/a.obj', 'all/a/a.mtl', 'all/a/tex/w.png', 'all/b/b.obj', 'all/b/w.png'))
      .toEqual(['a/: a.obj a.mtl w.png', 'b/: b.obj w.png']);
    expect(planned('house/obj/house.obj', 'house/tex/wall.png')).toEqual(['house/: house.obj wall.png']);
  });

  it('that are hidden are left out', () => {
    expect(planned('house/house.obj', 'house/.DS_Store', '__MACOSX/house/house.obj', '.git/a.ply')).toEqual(['house.obj: house.obj']);
  });

  it('must hold a mesh', () => {
    expect(planned('house.mtl', 'wall.png')[0]).toMatch(/no mesh/);
    expect(planned('.ply')[0]).toMatch(/no mesh/);
  });

  it('must tell which mesh they belong to', () => {
    expect(planned('a.obj', 'b.obj', 'wall.png')[0]).toMatch(/not clear which mesh wall\.png/);
    expect(planned('a.ply', 'b.ply', 'wall.png')[0]).toMatch(/not clear/);
  });

  it('must have names of their own where they come to lie', () => {
    expect(planned('a.obj', 'x/wall.png', 'y/Wall.png')).toEqual(['a has two files called Wall.png: rename one.']);
  });

  it('must not be larger than the server takes', () => {
    const { uploads, problems } = plan([chosen('a.obj', 600), chosen('a.mtl', 401), chosen('b.ply', 1000)], 1000, '1 kB');
    expect(problems).toEqual(['a is larger than 1 kB, the most that this server takes.']);
    expect(uploads.map(({ name, bytes }) => [name, bytes])).toEqual([['b.ply', 1000]]);
  });
});
