// The stored versions of a path, as the service has them.
import { get, resourcePath } from "../api.js";
import { Draft } from "./draft.js";

const MAIN_BRANCH = "main";

/**
 * All versions of a path, oldest first.
 * @param {string} path
 * @returns {Promise<Version[]>}
 */
export const readVersions = (path) => get(resourcePath("paths", path, "versions"));

/**
 * One version of a path with its curve.
 * @param {string} path
 * @param {number} number
 * @returns {Promise<SavedVersion>}
 */
export const readVersion = (path, number) => get(resourcePath("paths", path, "versions", number));

/**
 * A draft of the newest version on a path's main branch.
 * @param {string} path
 * @param {Version[]} versions
 */
export async function newDraft(path, versions) {
  const newest = versions.findLast((version) => version.branch === MAIN_BRANCH) ?? versions[versions.length - 1];
  const saved = await readVersion(path, newest.number);
  return new Draft(path, newest, saved.path.curve);
}
