// Builds what the package ships: viewer.js for reports, notebooks and pages, report.js for reports, studio.js for the studio's page.
// `node build.mjs` writes into src/flexstage; `node build.mjs FOLDER` writes all files into FOLDER, for a comparison.
// The same packages give the same bytes: no dates, no paths.

import { build } from "esbuild";
import { mkdir, readFile, readdir, writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const given = process.argv[2];
const folder = (path) => given ?? join(here, "..", "src", "flexstage", path);

const common = {
  absWorkingDir: here,
  bundle: true,
  charset: "ascii",
  format: "iife",
  legalComments: "none", // whole licences stand beside each bundle, and on top of the one that pages carry
  logLevel: "warning",
  metafile: true,
  minify: true,
  target: ["es2022"],
};

/** The packages of a bundle, by the folders of node_modules that its inputs lie in. */
function packages(metafile) {
  const names = Object.keys(metafile.inputs).map((path) => /node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(path)?.[1]);
  return [...new Set(names.filter(Boolean))].sort();
}

/** The licence of a package, with its name and version. */
async function licence(name) {
  const root = join(here, "node_modules", name);
  const about = JSON.parse(await readFile(join(root, "package.json"), "utf8"));
  const file = (await readdir(root)).find((each) => /^licen[cs]e/i.test(each));
  if (!file) throw new Error(`${name} has no file with its licence`);
  return `${name} ${about.version} (${about.license})\n\n${(await readFile(join(root, file), "utf8")).trim()}\n`;
}

async function licences(entry) {
  const { metafile } = await build({ ...common, entryPoints: [entry], write: false, outdir: "." });
  return (await Promise.all(packages(metafile).map(licence))).join(`\n${"-".repeat(80)}\n\n`);
}

/** One bundle of an entry, and the licences of what is in it beside it. */
async function bundle(entry, target, name, options = {}) {
  await mkdir(target, { recursive: true });
  const texts = await licences(entry);
  const banner = options.carries ? { js: `/*\n${texts.replaceAll("*/", "* /")}*/` } : {};
  const { carries, ...rest } = options;
  await build({ ...common, ...rest, banner, entryPoints: [{ in: entry, out: name }], outdir: target });
  await writeFile(join(target, `${name}-licences.txt`), texts);
}

await bundle("src/viewer/index.ts", folder("show/static"), "viewer", { globalName: "flexstage", carries: true });
await build({ ...common, entryPoints: [{ in: "src/report/index.ts", out: "report" }], outdir: folder("show/static") });
await bundle("src/studio/main.ts", folder("apps/studio/static"), "studio");
