// Checks what the page gives to other pages, in headless Chromium: the link, the frame and the element of its sheet "Share", each in a page of
// its own; and that a frame leaves the Back button of the page around it alone.
//
//   node embedding.mjs PICTURES PAGE HIERARCHY
//
// PAGE: the directory that `npm run build` of viewer/ makes, dist/page. Pictures go to the directory PICTURES. Exit code 2: wrong use; else
// see browser.mjs.
import path from 'node:path';
import { addStyle, collectComplaints, comparePictures, inChromium, readHierarchy, until } from './browser.mjs';
import { withSite } from './site.mjs';

const WINDOW = { viewport: { width: 900, height: 640 }, reducedMotion: 'reduce' };
const HOST = 'host.html';
const MOST_DIFFERENCE = 1.5; // of 255

function settle(frame) {
  return frame.waitForFunction(() => window.meshhier?.settled());
}

async function open(browser, address, complaints = []) {
  const page = await browser.newPage(WINDOW);
  collectComplaints(page, complaints, ['error', 'warning']);
  await page.goto(address);
  return page;
}

/// A page of somebody else, with that in it.
async function host(browser, origin, code, complaints) {
  const page = await browser.newPage(WINDOW);
  collectComplaints(page, complaints);
  const body = `<!doctype html><link rel="icon" href="data:,"><title>host</title><h1>A page</h1>${code}`;
  await page.route(`**/${HOST}`, (route) => route.fulfill({ contentType: 'text/html', body }));
  await page.goto(`${origin}/${HOST}`);
  return page;
}

/// Returns what the sheet has, of a camera that was moved.
async function share(browser, report, origin, { name }, pictures) {
  const page = await open(browser, `${origin}/index.html#models/${name}.hier`);
  await page.context().grantPermissions(['clipboard-read', 'clipboard-write']);
  await settle(page);
  await page.keyboard.press('ArrowLeft');
  await page.keyboard.press('+');
  await settle(page);
  const camera = await page.evaluate(() => window.meshhier.camera());
  await page.getByRole('button', { name: 'Share', exact: true }).click();
  await page.getByRole('button', { name: 'Copy' }).first().click();
  await page.getByRole('status').filter({ hasText: 'Copied' }).waitFor();
  const copied = await page.evaluate(() => navigator.clipboard.readText());
  const [link, frame, element] = await Promise.all(['Link to this view', 'Frame for another page', 'Element for another page'].map((field) => page.getByRole('textbox', { name: field }).inputValue()));
  report.line('share copy', copied === link && link === page.url(), link);
  await page.screenshot({ path: path.join(pictures, 'share.png') });
  await page.getByRole('button', { name: /About this model/ }).click();
  const about = await page.getByRole('region', { name: 'About this model' }).innerText();
  report.line('share information', /Triangles\s+[1-9]/.test(about) && !/Licence/.test(about), about.replace(/\s+/g, ' '));
  await page.screenshot({ path: path.join(pictures, 'information.png') });
  await page.close();
  return { camera, link, frame, element };
}

async function checkLink(browser, report, { link, camera }) {
  const page = await open(browser, link);
  await settle(page);
  const shown = await page.evaluate(() => window.meshhier.camera());
  report.line('share link', JSON.stringify(shown) === JSON.stringify(camera), 'shows the same view');
  await page.close();
}

async function checkFrame(browser, report, origin, { frame: code, camera }) {
  const complaints = [];
  const page = await host(browser, origin, code, complaints);
  const frame = page.frames()[1];
  await settle(frame);
  const shown = await frame.evaluate(() => window.meshhier.camera());
  report.line('share frame', JSON.stringify(shown) === JSON.stringify(camera), `shows the same view as ${await page.locator('iframe').getAttribute('title')}`);
  report.line('share frame console', complaints.length === 0, complaints.join('; ') || 'no errors');
  await page.close();
}

async function checkElement(browser, report, origin, { element: code, camera }, pictures) {
  const complaints = [];
  const page = await host(browser, origin, code, complaints);
  await page.waitForFunction(() => document.querySelector('meshhier-viewer').view?.stats().settled);
  const before = await page.evaluate(() => document.querySelector('meshhier-viewer').camera);
  report.line('share element', before === [...camera.position, ...camera.target].join(), `from ${before}`);
  await page.screenshot({ path: path.join(pictures, 'element.png') });
  const empty = await page.locator('meshhier-viewer').screenshot();
  await page.keyboard.press('Tab');
  await page.keyboard.press('ArrowRight');
  await page.waitForFunction((one) => document.querySelector('meshhier-viewer').camera !== one, before);
  report.line('share element keys', await until(page, async () => !empty.equals(await page.locator('meshhier-viewer').screenshot())), 'turn it');
  await page.evaluate(() => { document.querySelector('meshhier-viewer').src = 'nothing.hier'; });
  const alert = page.getByRole('alert');
  await alert.waitFor();
  report.line('share element problem', (await alert.innerText()).includes('404'), await alert.innerText());
  await page.evaluate(() => document.querySelector('meshhier-viewer').remove());
  const own = complaints.filter((text) => !text.includes('404'));
  report.line('share element console', own.length === 0, own.join('; ') || 'no errors');
  await page.close();
}

/// On white, without what lies over it.
async function bareScreenshot(page, shown) {
  await addStyle(page, 'body, .view { background: #fff !important } .top-bar, .bar, .busy { display: none !important }');
  return page.locator(shown).screenshot();
}

/// The same view in the page and in an element as large: one light, one tone curve.
async function checkLight(browser, report, origin, { name }) {
  const own = await open(browser, `${origin}/index.html?model=models/${name}.hier`);
  await settle(own);
  const { position, target } = await own.evaluate(() => window.meshhier.camera());
  const inPage = await bareScreenshot(own, '.surface canvas');
  const { width, height } = WINDOW.viewport;
  const code = `<style>body { margin: 0 } h1 { display: none }</style><script type="module" src="${origin}/meshhier-viewer.js"></script><meshhier-viewer style="display: block; width: ${width}px; height: ${height}px" camera="${[...position, ...target]}" src="${origin}/models/${name}.hier"></meshhier-viewer>`;
  const page = await host(browser, origin, code, []);
  await page.waitForFunction(() => document.querySelector('meshhier-viewer').view?.stats().settled);
  const inElement = await bareScreenshot(page, 'meshhier-viewer');
  const { mean, covered } = await comparePictures(page, inPage, inElement);
  report.line('one light', covered > 0.01 && mean <= MOST_DIFFERENCE, `the page and the element are ${mean.toFixed(2)} of 255 from each other where the model is`);
  await Promise.all([own.close(), page.close()]);
}

/// Registers a plug-in in a page's view: it colours the model green, says where it was tapped, and adds a sign.
const STRANGER = `(register) => register(() => ({
  name: 'stranger',
  shading: { uniforms: {}, key: () => 'green', edit: (shader) => { shader.fragmentShader = shader.fragmentShader.replace('#include <opaque_fragment>', 'outgoingLight = vec3(0.0, 1.0, 0.0);\\n#include <opaque_fragment>'); } },
  enter: ({ root }) => root.append(Object.assign(document.createElement('em'), { id: 'stranger', textContent: 'none' })),
  drawn: ({ renderer }) => { window.strangerDrew = renderer.domElement.width; },
  tapped: (right, up) => { window.strangerTapped = [right, up].map((value) => value.toFixed(1)).join(); return true; },
}))`;

/// The same plug-in in the page and in the element.
async function checkPlugin(browser, report, origin, { name }) {
  const hosts = [
    ['page', await open(browser, `${origin}/index.html?model=models/${name}.hier`), 'window.meshhier.view.registerPlugin(make())', () => window.meshhier?.settled(), '.surface canvas'],
    ['element', await host(browser, origin, `<script type="module" src="${origin}/meshhier-viewer.js"></script><meshhier-viewer src="${origin}/models/${name}.hier"></meshhier-viewer>`, []),
      "document.querySelector('meshhier-viewer').registerPlugin(make)", () => document.querySelector('meshhier-viewer').view?.stats().settled, 'meshhier-viewer canvas'],
  ];
  for (const [what, page, register, settled, canvas] of hosts) {
    await page.waitForFunction(settled);
    const before = await page.locator(canvas).screenshot();
    await page.evaluate(`(${STRANGER})((make) => ${register})`);
    await page.waitForFunction(() => window.strangerDrew > 0);
    await page.locator(canvas).click();
    await page.waitForFunction(() => window.strangerTapped !== undefined);
    const [tapped, sign] = [await page.evaluate(() => window.strangerTapped), await page.locator('#stranger').count()];
    const { mean } = await comparePictures(page, before, await page.locator(canvas).screenshot());
    report.line(`plug-in in the ${what}`, tapped === '0.0,0.0' && sign === 1 && mean > 10, `tapped at ${tapped}, ${sign} sign, ${mean.toFixed(0)} of 255 greener`);
    await page.close();
  }
}

/// The gallery in a frame: models come and go, and Back leads from the page around it to where its reader was before.
async function checkBack(browser, report, origin, { name }) {
  const complaints = [];
  const page = await host(browser, origin, `<iframe src="${origin}/index.html" width="800" height="500"></iframe>`, complaints);
  const frame = page.frames()[1];
  const before = await page.evaluate(() => history.length);
  await frame.locator('a.cell', { hasText: name }).first().click();
  await settle(frame);
  await frame.getByRole('button', { name: 'Back' }).click();
  await frame.locator('a.cell').first().waitFor();
  await frame.evaluate((one) => window.meshhier.open(one), name);
  await settle(frame);
  const after = await page.evaluate(() => history.length);
  report.line('frame history', before === after, `${after} entries, as before`);
  await page.goBack();
  report.line('frame back', !page.url().includes(HOST), `leads to ${page.url()}`);
  report.line('frame console', complaints.length === 0, complaints.join('; ') || 'no errors');
  await page.close();
}

async function check(browser, report, [pictures, pageDirectory, directory]) {
  const hierarchy = readHierarchy(directory);
  await withSite(pageDirectory, [hierarchy], async (origin) => {
    const shared = await share(browser, report, origin, hierarchy, pictures);
    await checkLink(browser, report, shared);
    await checkFrame(browser, report, origin, shared);
    await checkElement(browser, report, origin, shared, pictures);
    await checkLight(browser, report, origin, hierarchy);
    await checkPlugin(browser, report, origin, hierarchy);
    await checkBack(browser, report, origin, hierarchy);
  });
}

const parameters = process.argv.slice(2);
if (parameters.length !== 3) {
  console.log('usage: node embedding.mjs PICTURES PAGE HIERARCHY');
  process.exit(2);
}
process.exit(await inChromium(parameters[0], (browser, report) => check(browser, report, parameters)));
