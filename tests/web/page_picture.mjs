// Makes the picture of the page in the README in headless Chromium: page.png.
//
//   node page_picture.mjs MESHHIER PICTURES FOLDER NAME
//
// FOLDER: has NAME.hier. Exit code 2: wrong use; else see browser.mjs.
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { collectComplaints, inChromium, until } from './browser.mjs';
import { startServer } from './meshhier_server.mjs';

const PAGE = path.join(path.dirname(fileURLToPath(import.meta.url)), '../../viewer/dist/page');
const SIZE = { width: 960, height: 520 };

/// Whether two pictures in a row are the same: all tiles have come.
async function isSettled(page, seen) {
  await page.waitForTimeout(1000);
  const picture = await page.screenshot();
  const same = seen.last !== null && seen.last.equals(picture);
  seen.last = picture;
  return same;
}

const [meshhier, pictures, folder, name] = process.argv.slice(2);
if (name === undefined) {
  console.log('usage: node page_picture.mjs MESHHIER PICTURES FOLDER NAME');
  process.exit(2);
}
process.exit(await inChromium(pictures, async (browser, report) => {
  const server = startServer(meshhier, folder, '--viewer', PAGE);
  const complaints = [];
  const page = await browser.newPage({ viewport: SIZE });
  collectComplaints(page, complaints);
  await page.goto(`${await server.url}#models/${name}.hier`);
  await page.locator('canvas').waitFor();
  const seen = { last: null };
  const settled = await until(page, () => isSettled(page, seen));
  await page.screenshot({ path: path.join(pictures, 'page.png') });
  await server.stop();
  report.line('page', settled && complaints.length === 0, complaints.join(' ') || path.join(pictures, 'page.png'));
}));
