// SPDX-License-Identifier: MIT
// Pictures go to the GPU before the tiles that show them are drawn, a few texels in each frame: one that came with several tiles would take
// several times as long.
import type { Texture, WebGLRenderer } from 'three';

/// So many texels go in one frame, but for one texture that has more: a phone takes some milliseconds for as many. While the camera rests a frame
/// may take longer: nothing is seen to move.
const FRAME_TEXELS = { moving: 2 ** 19, resting: 2 ** 21 };

interface WaitingTexture {
  readonly key: number;
  readonly texture: Texture;
}

function texelsOf({ image }: Texture): number {
  const { width, height } = image as { readonly width: number; readonly height: number };
  return width * height;
}

export class Uploads {
  private queue: WaitingTexture[] = [];

  /// The textures of a tile have come.
  add(key: number, textures: readonly Texture[]): void {
    this.queue.push(...textures.map((texture) => ({ key, texture })));
  }

  /// The tile goes.
  forget(key: number): void {
    this.queue = this.queue.filter((each) => each.key !== key);
  }

  /// True until all of a tile's textures are on the GPU.
  awaits(key: number): boolean {
    return this.queue.some((each) => each.key === key);
  }

  /// Uploads what goes in one frame, first what came first. Returns whether anything is left.
  step(renderer: Pick<WebGLRenderer, 'initTexture'>, isMoving: boolean): boolean {
    const most = FRAME_TEXELS[isMoving ? 'moving' : 'resting'];
    for (let texels = 0; this.queue.length > 0; ) {
      const [{ texture }] = this.queue;
      texels += texelsOf(texture);
      renderer.initTexture(texture);
      this.queue.shift();
      if (this.queue.length > 0 && texels + texelsOf(this.queue[0].texture) > most) break;
    }
    return this.queue.length > 0;
  }
}
