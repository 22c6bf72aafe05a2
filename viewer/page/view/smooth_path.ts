// SPDX-License-Identifier: MIT
// The way from one pose to another that seems shortest: it draws back, goes there and comes close again, in one movement.
// J. J. van Wijk, W. A. A. Nuij: Smooth and Efficient Zooming and Panning, 2003, for a camera that looks at a target: the part
// of the surface that is seen is as wide as the camera is away. Meanwhile it turns, upright.
import { Vector3 } from 'three';
import { CameraPose } from '../../src/scene/camera_pose.js';

/// How much of the way is drawing back: what people liked best there.
const RHO = Math.SQRT2;
const SECONDS = { aLength: 0.7, aRadian: 0.6, least: 0.65, most: 4 };

/// From a width to another one at a distance. At `s` of `length`: where on the line, and how wide.
interface Zoom {
  readonly length: number;
  at(s: number): { along: number; width: number };
}

function zoomBetween(from: number, to: number, distance: number): Zoom {
  const rho2 = RHO * RHO;
  const far = rho2 * distance;
  if (!(far > 1e-6 * Math.max(from, to))) {
    const length = Math.abs(Math.log(to / from)) / RHO;
    return { length, at: (s) => ({ along: length === 0 ? 1 : s / length, width: length === 0 ? to : from * (to / from) ** (s / length) }) };
  }
  const start = -Math.asinh((to * to - from * from + far * far) / (2 * from * far));
  const end = -Math.asinh((to * to - from * from - far * far) / (2 * to * far));
  const at = (s: number): ReturnType<Zoom['at']> => {
    const r = RHO * s + start;
    const along = (from / rho2) * (Math.cosh(start) * Math.tanh(r) - Math.sinh(start));
    return { along: along / distance, width: (from * Math.cosh(start)) / Math.cosh(r) };
  };
  return { length: (end - start) / RHO, at };
}

/// To the viewer: around the vertical, and up from the horizon.
interface ViewSide {
  readonly around: number;
  readonly up: number;
}

function sideOf({ forward }: CameraPose): ViewSide {
  return { around: Math.atan2(-forward.x, -forward.z), up: Math.asin(Math.min(Math.max(-forward.y, -1), 1)) };
}

function directionOf({ around, up }: ViewSide): Vector3 {
  return new Vector3(Math.cos(up) * Math.sin(around), Math.sin(up), Math.cos(up) * Math.cos(around));
}

export class SmoothPath {
  readonly milliseconds: number;
  private readonly zoom: Zoom;
  private readonly side: ViewSide;
  private readonly turn: ViewSide;

  constructor(private readonly from: CameraPose, private readonly to: CameraPose) {
    this.zoom = zoomBetween(from.distance, to.distance, from.target.distanceTo(to.target));
    this.side = sideOf(from);
    const end = sideOf(to);
    const around = end.around - this.side.around;
    this.turn = { around: around - 2 * Math.PI * Math.round(around / (2 * Math.PI)), up: end.up - this.side.up };
    const seconds = Math.max(this.zoom.length * SECONDS.aLength, Math.hypot(this.turn.around, this.turn.up) * SECONDS.aRadian);
    this.milliseconds = 1000 * Math.min(Math.max(seconds, SECONDS.least), SECONDS.most);
  }

  /// `t`: of the way, from 0 to 1.
  at(t: number): CameraPose {
    if (t <= 0) return this.from;
    if (t >= 1) return this.to;
    const { along, width } = this.zoom.at(t * this.zoom.length);
    const target = this.from.target.clone().lerp(this.to.target, along);
    const side = { around: this.side.around + t * this.turn.around, up: this.side.up + t * this.turn.up };
    return new CameraPose(directionOf(side).multiplyScalar(width).add(target), target);
  }
}
