// SPDX-License-Identifier: MIT
// Tiles of a hierarchy with normal maps are of two kinds, with a map and without: each has a program of its own on the GPU. It takes longer to
// compile than a frame; so both are begun when the first tile is drawn, and stay whatever tiles come and go.
import type { BufferGeometry, Camera, Material, Mesh, Scene, WebGLRenderer } from 'three';

type Sample = Mesh<BufferGeometry, Material>;

/// A tile of either kind.
export interface DrawnTileSurface {
  /// How it is shown; tiles of both kinds that are shown alike have one.
  readonly surface: string;
  /// Makes what tiles of both kinds are drawn as; their geometry is never filled. None: there is but one kind.
  makeSamples(): Sample[];
}

export class TilePrograms {
  private surface: string | null = null;
  private samples: readonly Sample[] = [];
  /// Resolves once the programs that were begun can be used without waiting for them.
  compiled: Promise<unknown> = Promise.resolve();

  /// A tile is drawn.
  drawn(tile: DrawnTileSurface, renderer: WebGLRenderer, scene: Scene, camera: Camera): void {
    if (tile.surface === this.surface) return;
    this.forget();
    const samples = tile.makeSamples();
    [this.surface, this.samples] = [tile.surface, samples];
    const begin = async (sample: Sample): Promise<unknown> =>
      renderer.extensions.has('KHR_parallel_shader_compile') ? renderer.compileAsync(sample, camera, scene) : renderer.compile(sample, camera, scene);
    this.compiled = Promise.resolve().then(() => Promise.all(samples.map(begin))).catch(() => undefined); // once this frame's drawing is over; what fails is told when it is drawn
  }

  /// Programs that no tile needs either are deleted.
  forget(): void {
    for (const { material } of this.samples) material.dispose();
    [this.surface, this.samples] = [null, []];
  }
}
