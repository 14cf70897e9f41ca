// Where modules and files of the scripts beside this one are.

import { existsSync, readdirSync, statSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const target = join(process.env.CARGO_TARGET_DIR ?? join(here, '../target'), 'outside');

/** A file of a module that `outside/setup` has installed below target/. */
export async function load(name) {
  const path = join(target, 'node_modules', name);
  if (!existsSync(path)) {
    console.error(`there is no ${path}; outside/setup installs it`);
    process.exit(1);
  }
  const module = await import(pathToFileURL(path));
  return module.default ?? module;
}

/** Files and the files of folders, in order. */
export function filesOf(paths) {
  const inside = (path) => (statSync(path).isDirectory() ? readdirSync(path).map((name) => join(path, name)) : [path]);
  return paths.flatMap(inside).sort();
}
