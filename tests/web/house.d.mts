export type Plan = readonly [number, number, number, number];

export declare const HOUSE: {
  readonly size: readonly [number, number];
  readonly floors: readonly [number, number];
  readonly ceilings: readonly [number, number];
  readonly wall: { readonly ground: Plan; readonly upper: Plan };
  readonly door: { readonly ground: Plan; readonly upper: Plan; readonly height: number };
  readonly table: Plan;
  readonly cupboard: Plan;
  readonly bed: Plan;
  readonly colours: Readonly<Record<'floor' | 'ceiling' | 'wall', readonly [number, number, number]>>;
  readonly stairs: { readonly plan: Plan; readonly steps: number; readonly rise: number; readonly tread: number };
};

export interface HouseMesh {
  readonly positions: number[];
  readonly corners: number[];
  readonly colours: number[];
}

export declare function house(options?: { readonly outside?: boolean; readonly cell?: number }): HouseMesh;
export declare function plyOf(mesh: HouseMesh): string;
