// Takes a picture of each hierarchy as the page of viewer/ shows it when it opens, whole and settled.
//
//   node previews.mjs PICTURES PAGE HIERARCHY...
//
// PAGE: the directory that `npm run build` of viewer/ makes. Pictures are named after the hierarchies. Exit code 2: wrong use; else see
// browser.mjs.
import path from 'node:path';
import { inChromium, readHierarchy } from './browser.mjs';
import { withSite } from './site.mjs';

const WINDOW = { viewport: { width: 800, height: 600 }, reducedMotion: 'reduce' };

async function preview(browser, report, { name }, origin, pictures) {
  const page = await browser.newPage(WINDOW);
  await page.goto(`${origin}/index.html?model=models/${name}.hier`);
  await page.waitForFunction(() => window.meshhier?.settled());
  const { tiles, triangles, failed } = await page.evaluate(() => window.meshhier.stats());
  await page.screenshot({ path: path.join(pictures, `${name}.png`) });
  report.line(`${name} preview`, failed === 0, `${tiles} tiles, ${triangles} triangles`);
  await page.close();
}

async function previewAll(browser, report, [pictures, page, ...directories]) {
  const hierarchies = directories.map(readHierarchy);
  await withSite(page, hierarchies, async (origin) => {
    for (const hierarchy of hierarchies) await preview(browser, report, hierarchy, origin, pictures);
  });
}

const parameters = process.argv.slice(2);
if (parameters.length < 3) {
  console.log('usage: node previews.mjs PICTURES PAGE HIERARCHY...');
  process.exit(2);
}
process.exit(await inChromium(parameters[0], (browser, report) => previewAll(browser, report, parameters)));
