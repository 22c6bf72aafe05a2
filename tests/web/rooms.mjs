// Rooms in the page, in headless Chromium: a house as if scanned from within shows its floors from above, is walked through, and one storey of
// it is shown. `meshhier preview` of the same links draws the same.
//
//   node rooms.mjs MESHHIER PICTURES PAGE
//
// The house is made here (house.mjs). Exit code 2: wrong use; else see browser.mjs.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { addStyle, collectComplaints, decodePicture, inChromium, PATIENCE, readHierarchy, steady, until, withoutRestDetail } from './browser.mjs';
import { house, HOUSE, plyOf } from './house.mjs';
import { withSite } from './site.mjs';

const SIZE = { width: 640, height: 480 };
const EYES = 0.64 * HOUSE.ceilings[0];
const NEAR = 0.05; // metres
const ABOVE = '5,22,2.51,5,0,2.5';
const ASIDE = '14,12,16,5,1,4';
/// Seen from outside: as it is, with its ceilings, in parallel rays, and the lower storey.
const LOOKS = ['', '&dollhouse=off', '&projection=parallel', `&storey=-1,${HOUSE.ceilings[0] - 0.1}`];
const MOST_OTHER = 0.01; // of the picture's pixels: along edges

class Visitor {
  constructor(browser, origin, report, pictures) {
    Object.assign(this, { browser, origin, report, pictures, complaints: [] });
  }

  check(what, good, text) {
    this.report.line(`rooms ${what}`, good, text);
  }

  /// `spot`: what the link tells after the model. Opens once it is judged what the model is.
  async open(spot) {
    const page = await this.browser.newPage({ viewport: SIZE, reducedMotion: 'reduce' });
    collectComplaints(page, this.complaints);
    await page.addInitScript(withoutRestDetail);
    await page.goto(`${this.origin}/index.html#models/house.hier&${spot}`);
    await page.waitForFunction(() => window.meshhier?.view?.plugins.named('page dollhouse') !== undefined);
    await this.settle(page);
    return page;
  }

  async settle(page) {
    await page.waitForFunction(() => window.meshhier?.settled());
  }

  picture(page, what) {
    return page.screenshot({ path: path.join(this.pictures, `rooms-${what}.png`) });
  }
}

function camera(page) {
  return page.evaluate(() => window.meshhier.camera().position);
}

/// Holds a key until it comes to that, or for so long that it does not; then until the camera stands.
async function hold(page, key, holds, milliseconds) {
  await page.keyboard.down(key);
  for (const began = Date.now(); Date.now() - began < milliseconds && !holds(await camera(page)); ) await page.waitForTimeout(50);
  await page.keyboard.up(key);
  return steady(page, () => camera(page));
}

async function pickedHeight(page) {
  await page.keyboard.press('i');
  await page.locator('.tool-card').waitFor();
  await page.locator('.surface').focus();
  await page.keyboard.press('Enter');
  const row = page.locator('.tool-figures > div', { hasText: /^y/ }).first();
  await row.waitFor();
  const text = await row.locator('dd').innerText();
  await page.keyboard.press('Escape');
  return Number.parseFloat(text);
}

async function checkDollhouse(visitor, decoder) {
  for (const [choice, surface, height] of [['', 'floor', HOUSE.floors[1]], ['&dollhouse=off', 'ceiling', HOUSE.ceilings[1]]]) {
    const page = await visitor.open(ABOVE + choice);
    const hides = await page.evaluate(() => window.meshhier.view.hidesBacks);
    visitor.check(`from above${choice}`, hides === (choice === ''), `backs are ${hides ? 'not ' : ''}drawn`);
    const pixels = await decodePicture(decoder, await visitor.picture(page, `above-${surface}`));
    const at = 4 * (SIZE.width * (SIZE.height / 2) + SIZE.width / 2);
    const [r, g, b] = pixels.slice(at, at + 3);
    visitor.check(`the ${surface} is seen`, surface === 'floor' ? g > 1.3 * b && g > 1.3 * r : b > 1.3 * g, `${r}, ${g}, ${b} in the middle`);
    const y = await pickedHeight(page);
    visitor.check(`the ${surface} is picked`, Math.abs(y - height) < NEAR, `at ${y}`);
    await page.close();
  }
}

/// What a pixel shows: a floor, a ceiling, or something else.
function surfaceAt(pixels, i) {
  const [r, g, b, alpha] = pixels.slice(4 * i, 4 * i + 4);
  if (alpha < 128) return 'other';
  return g > 1.3 * b && g > 1.3 * r ? 'floor' : b > 1.3 * g ? 'ceiling' : 'other';
}

/// The page without its bars, and the program's picture of the same link.
async function checkPreview(visitor, decoder, draw) {
  for (const look of LOOKS) {
    const page = await visitor.open(`${ASIDE}&light=flat&cavities=off${look}`);
    await addStyle(page, '.top-bar, .bar, .busy, .tools, .tool-lasting { visibility: hidden !important }');
    if (look.includes('storey')) await until(page, () => page.evaluate(() => window.meshhier.view.plugins.cuts.length > 0));
    await visitor.settle(page);
    const shown = await decodePicture(decoder, await visitor.picture(page, `page${LOOKS.indexOf(look)}`));
    const drawn = await decodePicture(decoder, draw(page.url(), `preview${LOOKS.indexOf(look)}`));
    const places = Array.from({ length: SIZE.width * SIZE.height }, (_, i) => i);
    const other = places.filter((i) => surfaceAt(shown, i) !== surfaceAt(drawn, i)).length / places.length;
    const known = places.filter((i) => surfaceAt(shown, i) !== 'other').length / places.length;
    visitor.check(`preview${look}`, other < MOST_OTHER && known > 0.1, `${(100 * other).toFixed(2)} % of pixels show something else; floors and ceilings are ${(100 * known).toFixed(0)} %`);
    await page.close();
  }
}

async function checkWalk(visitor) {
  const page = await visitor.open(`3,${EYES},6,8,${EYES},6&walk=on`);
  await page.getByRole('button', { name: 'Stop walking' }).waitFor();
  await page.locator('.surface').focus();
  await hold(page, 'w', (place) => place[0] > 5.6, PATIENCE);
  const [x, y, z] = await hold(page, 'w', () => false, 2000);
  visitor.check('a wall', x > 5 && x < HOUSE.wall.ground[0] && Math.abs(y - EYES) < NEAR, `${x}, ${y}, ${z}`);
  await visitor.picture(page, 'wall');
  const before = page.url();
  await page.keyboard.press('Escape');
  await until(page, async () => !page.url().includes('walk=on'));
  const after = await camera(page);
  visitor.check('Escape leads out without a jump', Math.hypot(after[0] - x, after[1] - y, after[2] - z) < 1e-6 && before.includes('walk=on') && !page.url().includes('walk=on'), page.url());
  await page.close();
}

async function checkStairs(visitor) {
  const page = await visitor.open(`9.5,${EYES},0.4,9.5,${EYES},5&walk=on`);
  await page.getByRole('button', { name: 'Stop walking' }).waitFor();
  await page.locator('.surface').focus();
  const up = await hold(page, 'w', ([, , z]) => z > 5.3, PATIENCE);
  visitor.check('stairs lead up', Math.abs(up[1] - HOUSE.floors[1] - EYES) < NEAR, up.join(', '));
  await visitor.settle(page);
  await visitor.picture(page, 'upstairs');
  await page.close();
}

async function checkClick(visitor) {
  const page = await visitor.open(`3,${EYES},6.5,5,0.2,5.5&walk=on`);
  await page.getByRole('button', { name: 'Stop walking' }).waitFor();
  const begun = await camera(page);
  await page.mouse.click(SIZE.width / 2, SIZE.height / 2);
  const went = await until(page, async () => Math.hypot((await camera(page))[0] - begun[0]) > 1);
  const [x, y] = await camera(page);
  visitor.check('a click leads there', went && x < HOUSE.wall.ground[0] && Math.abs(y - EYES) < 0.2, `${begun} to ${x}, ${y}`);
  await page.close();
}

async function checkStorey(visitor) {
  const page = await visitor.open(ABOVE);
  await page.keyboard.press('y');
  const slider = page.getByRole('slider', { name: 'Storey' });
  await slider.waitFor();
  const most = await slider.getAttribute('max');
  await slider.focus();
  await page.keyboard.press('ArrowRight');
  await until(page, async () => page.url().includes('storey='));
  await visitor.settle(page);
  const text = await slider.getAttribute('aria-valuetext');
  const y = await pickedHeight(page);
  visitor.check('the lower storey', most === '2' && Math.abs(y) < NEAR && text.startsWith('1, floor at 0 '), `of ${most}: ${text}; picked at ${y}`);
  await visitor.picture(page, 'storey');
  const link = page.url().split('&').filter((part) => part.startsWith('storey=')).join();
  await page.close();
  const again = await visitor.open(`${ABOVE}&${link}`);
  await until(again, () => again.evaluate(() => window.meshhier.view.plugins.cuts.length > 0));
  const cuts = await again.evaluate(() => window.meshhier.view.plugins.cuts.length);
  visitor.check('a link to it', cuts === 2, `${link}: ${cuts} cuts`);
  await again.close();
}

async function main([meshhier, pictures, page]) {
  if (page === undefined) {
    console.error('usage: node rooms.mjs MESHHIER PICTURES PAGE');
    return 2;
  }
  const work = mkdtempSync(path.join(tmpdir(), 'meshhier-rooms-'));
  try {
    const [mesh, hierarchy] = [path.join(work, 'house.ply'), path.join(work, 'house.hier')];
    writeFileSync(mesh, plyOf(house()));
    execFileSync(meshhier, ['build', mesh, '-o', hierarchy, '--set', 'up=y', 'partition.vertices=400']);
    return await inChromium(pictures, (browser, report) => withSite(page, [readHierarchy(hierarchy)], async (origin) => {
      const visitor = new Visitor(browser, origin, report, pictures);
      const decoder = await browser.newPage();
      await checkDollhouse(visitor, decoder);
      await checkPreview(visitor, decoder, (link, name) => {
        const file = path.join(pictures, `rooms-${name}.png`);
        execFileSync(meshhier, ['preview', hierarchy, '--link', link, '--size', `${SIZE.width}x${SIZE.height}`, '--background', 'white', '--force', '-o', file], { stdio: 'ignore' });
        return readFileSync(file);
      });
      for (const check of [checkWalk, checkStairs, checkClick, checkStorey]) await check(visitor);
      visitor.check('console', visitor.complaints.length === 0, visitor.complaints.join('; ') || 'no complaints');
    }));
  } finally {
    rmSync(work, { recursive: true });
  }
}

process.exitCode = await main(process.argv.slice(2));
