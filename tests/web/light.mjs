// One light for all pictures: `meshhier preview` of a hierarchy's root is what the page's light makes of it in three, drawn by the same
// camera. Judged within the outline: along it the two count the parts of a pixel in different ways.
//
//   node light.mjs MESHHIER PICTURES HIERARCHY.hier...
//
// Exit code 2: wrong use; else see browser.mjs.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { collectComplaints, inChromium } from './browser.mjs';
import { serve } from './server.mjs';

const HERE = path.dirname(fileURLToPath(import.meta.url));
const ROOT = path.join(HERE, '../..');
const SIDE = 512;
// Of 255, on average: 1.62 of a terrain whose slopes are a few pixels wide, below 0.9 of all else without a map; 1.78 of a scan whose normal
// map has several texels a pixel: the page mixes normals before it lights them, `preview` their light. 4.9 of a terrain with such a map, whose
// slopes are shaded twenty times steeper.
const MOST = { plain: 1.7, mapped: 1.9, steep: 5.2 };
// No picture is lighter or darker as a whole.
const MOST_BIAS = 1;
const LEAST_PIXELS = 5000;

async function check(browser, report, origin, name, pictures) {
  const page = await browser.newPage({ viewport: { width: SIDE, height: SIDE } });
  const complaints = [];
  collectComplaints(page, complaints);
  await page.goto(`${origin}/light.html`);
  await page.waitForFunction(() => window.compareLight);
  const { pixels, mean, most, bias, rig, kind } = await page.evaluate(([url, preview, side]) => window.compareLight(url, preview, side), [`${origin}/models/${name}.hier`, `${origin}/previews/${name}.png`, SIDE]);
  await page.screenshot({ path: path.join(pictures, `light-${name}.png`) });
  report.line(`light of ${name}`, pixels > LEAST_PIXELS && mean <= MOST[kind] && Math.max(...bias.map(Math.abs)) <= MOST_BIAS && complaints.length === 0,
    `${mean.toFixed(2)} of 255 on average, ${most} at the most, ${bias.map((value) => value.toFixed(2)).join(', ')} in red, green and blue; ${pixels} pixels, ${kind}, ${rig}${complaints.length > 0 ? `; ${complaints.join('; ')}` : ''}`);
  await page.close();
}

async function checkAll(browser, report, [meshhier, pictures, ...hierarchies]) {
  const previews = mkdtempSync(path.join(tmpdir(), 'meshhier-light-'));
  const names = hierarchies.map((hierarchy) => path.basename(hierarchy, '.hier'));
  hierarchies.forEach((hierarchy, i) => execFileSync(meshhier, ['preview', hierarchy, '--level', '0', '--size', `${SIDE}x${SIDE}`, '-o', path.join(previews, `${names[i]}.png`)]));
  const models = Object.fromEntries(hierarchies.map((hierarchy, i) => [`/models/${names[i]}.hier`, hierarchy]));
  const server = await serve({ ...models, '/previews': previews, '/packages': path.join(ROOT, 'viewer/node_modules'), '/viewer': path.join(ROOT, 'viewer/dist'), '': HERE });
  try {
    for (const name of names) await check(browser, report, server.origin, name, pictures);
  } finally {
    server.close();
    rmSync(previews, { recursive: true });
  }
}

const given = process.argv.slice(2);
if (given.length < 3) {
  console.log('usage: node light.mjs MESHHIER PICTURES HIERARCHY.hier...');
  process.exit(2);
}
process.exit(await inChromium(given[1], (browser, report) => checkAll(browser, report, given)));
