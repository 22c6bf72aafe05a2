// SPDX-License-Identifier: MIT
// Keeps in the browser what was chosen for the tools. Whatever is stored there, what comes out is sound.
import { isUnitName, type UnitName } from '../../src/tools/units.js';

export interface ToolSettings {
  modelUnit: UnitName;
  shownUnit: UnitName;
  snaps: boolean;
}

const KEY = 'meshhier-tools';
const DEFAULTS: ToolSettings = { modelUnit: 'unit', shownUnit: 'unit', snaps: false };

function stored(): Partial<Record<keyof ToolSettings, unknown>> {
  try {
    const value: unknown = JSON.parse(localStorage.getItem(KEY) ?? '{}');
    return typeof value === 'object' && value !== null ? value : {};
  } catch {
    return {}; // no storage, or nothing of ours in it
  }
}

/// `modelUnit`: of a model whose unit is known.
export function loadToolSettings(modelUnit: UnitName | null): ToolSettings {
  const { modelUnit: model, shownUnit: shown, snaps } = stored();
  return {
    modelUnit: modelUnit ?? (isUnitName(model) ? model : DEFAULTS.modelUnit),
    shownUnit: isUnitName(shown) ? shown : DEFAULTS.shownUnit,
    snaps: snaps === true,
  };
}

export function saveToolSettings(settings: ToolSettings): void {
  try {
    localStorage.setItem(KEY, JSON.stringify(settings));
  } catch {
    // They last as long as the page.
  }
}
