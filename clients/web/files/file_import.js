// Files on their way to demonstrations: sent, examined, corrected, and imported, all of them or none.
import { get, post, remove, resourcePath, upload } from "../api.js";

/**
 * How a file is read; what is empty, the file or its format has to say.
 * @typedef {object} Choices
 * @property {string} format
 * @property {string} units
 * @property {string} time
 * @property {number} rate
 * @property {string} columns
 * @property {string} quaternion
 * @property {string} track
 * @property {Record<number, MotionMarks>} marks of its motions, by their numbers from 1
 */

/**
 * Where somebody said that a motion takes and puts the object.
 * @typedef {{grasp: number | null, release: number | null, whole: boolean}} MotionMarks
 */

/** Whether anything was said of a motion. @param {MotionMarks} [said] */
export const isMarked = (said) => Boolean(said && (said.whole || said.grasp !== null || said.release !== null));

/** @type {Readonly<MotionMarks>} */
export const NO_MARKS = Object.freeze({ grasp: null, release: null, whole: false });

/** @type {Readonly<Choices>} */
export const NO_CHOICES = Object.freeze({
  format: "",
  units: "",
  time: "",
  rate: 0,
  columns: "",
  quaternion: "",
  track: "",
  marks: {},
});

/** What the files have in common. @typedef {{task: string, objectAtGrasp: boolean}} ImportPlace */

let count = 0; // files so far

export class ImportFile {
  id = String(++count);
  /** @type {Choices} */
  choices = { ...NO_CHOICES };
  upload = ""; // its id at the service; "": it was not sent yet
  /** @type {FileReport | null} */
  report = null;
  error = ""; // why it was not sent or examined
  motion = 1; // number of the one that is shown
  asked = 1; // times that something was chosen
  examined = 0; // the time that the report is of

  /** @param {File} file */
  constructor(file) {
    this.file = file;
    this.name = file.name;
  }

  /** Whether the report is of what is chosen now. */
  get isExamined() {
    return this.examined === this.asked;
  }

  /** What was said of the motion that is shown. */
  get said() {
    return this.choices.marks[this.motion] ?? NO_MARKS;
  }

  /** Where the motion that is shown takes and puts the object: as marked, else as found where that is sure. */
  get shownMarks() {
    const { grasp, release } = this.said;
    const isFound = this.report?.motion === this.motion && !this.report.unsure.includes(this.motion);
    if (!isFound || grasp !== null || release !== null) return { grasp, release };
    return { grasp: this.report?.grasp ?? null, release: this.report?.release ?? null };
  }

  /** Whether it can be imported as it is. */
  get isReady() {
    return this.isExamined && !this.error && this.report !== null && !this.report.refusal;
  }
}

export class FileImport {
  /** @type {ImportFile[]} */
  files = [];
  /** @type {Job | null} */
  job = null; // that imports them
  #isWorking = false;

  /** @param {() => ImportPlace} place @param {() => void} onChange */
  constructor(place, onChange) {
    this.place = place;
    this.onChange = onChange;
  }

  /** @param {Iterable<File>} files */
  add(files) {
    this.files = [...this.files, ...[...files].map((file) => new ImportFile(file))];
    this.#work();
  }

  /** @param {string} id */
  find(id) {
    return this.files.find((file) => file.id === id);
  }

  /** @param {ImportFile[]} files that are taken away, and at the service too */
  remove(...files) {
    this.files = this.files.filter((file) => !files.includes(file));
    for (const { upload: id } of files) if (id) remove(resourcePath("uploads", id)).catch(() => null); // or it is forgotten
    this.onChange();
  }

  /** @param {ImportFile} file @param {Partial<Choices>} changes */
  choose(file, changes) {
    file.choices = { ...file.choices, ...changes };
    this.examineAgain(file);
  }

  /** Say where the motion that is shown takes and puts the object. @param {ImportFile} file @param {Partial<MotionMarks>} marks */
  mark(file, marks) {
    const { marks: others } = file.choices;
    this.choose(file, { marks: { ...others, [file.motion]: { ...NO_MARKS, ...marks } } });
  }

  /** @param {ImportFile} file @param {number} motion that is to be shown */
  show(file, motion) {
    file.motion = motion;
    this.examineAgain(file);
  }

  /** Read all others as this one, but for its marks, which are its own. @param {ImportFile} file */
  chooseForAll(file) {
    for (const other of this.files.filter((each) => each !== file)) {
      other.choices = { ...file.choices, marks: other.choices.marks };
      other.asked += 1;
      other.error = "";
    }
    this.#work();
  }

  /** @param {ImportFile[]} files */
  examineAgain(...files) {
    for (const file of files) {
      file.asked += 1;
      file.error = "";
    }
    this.#work();
  }

  /** Send all anew: the service keeps no file of an import that has ended. */
  sendAgain() {
    for (const file of this.files) file.upload = "";
    this.examineAgain(...this.files);
  }

  get isReady() {
    return this.files.length > 0 && this.files.every((file) => file.isReady);
  }

  /** Begin the import of all. */
  async begin() {
    const { task, objectAtGrasp } = this.place();
    const files = this.files.map((file) => ({ upload: file.upload, ...fileRequest(file) }));
    this.job = await post(resourcePath("tasks", task, "imports"), { files, object_at_grasp: objectAtGrasp });
    this.onChange();
  }

  /** Ask how the import stands; it may have ended while nobody heard of it. */
  async readJob() {
    const before = this.job;
    if (!before) return;
    const job = await get(resourcePath("jobs", before.id)).catch(() => null);
    if (!job || this.job !== before) return;
    this.job = job;
    this.onChange();
  }

  /** Send and examine one file after the other, as long as there are some. */
  async #work() {
    this.onChange();
    if (this.#isWorking) return;
    this.#isWorking = true;
    for (let file = this.#next(); file; file = this.#next()) {
      await this.#advance(file).catch((error) => {
        file.error = error.message;
      });
      this.onChange();
    }
    this.#isWorking = false;
  }

  #next() {
    return this.files.find((file) => !file.error && !file.isExamined);
  }

  /** @param {ImportFile} file */
  async #advance(file) {
    if (!file.upload) {
      const sent = await upload(`uploads?${new URLSearchParams({ name: file.name })}`, file.file);
      file.upload = sent.id;
      if (!this.files.includes(file)) this.remove(file); // meanwhile
      return;
    }
    const { asked, motion } = file;
    const { task, objectAtGrasp } = this.place();
    const examination = { file: fileRequest(file), task, object_at_grasp: objectAtGrasp, motion };
    const report = await post(
      resourcePath("uploads", file.upload, "examination"),
      examination,
      {},
      EXAMINATION_TIMEOUT,
    );
    [file.report, file.examined] = [report, asked];
    if (file.isExamined) file.motion = report.motion; // the first, where there are not as many
  }
}

const EXAMINATION_TIMEOUT = 120_000; // [ms]

/** How a file is to be read, as the service takes it. @param {Pick<ImportFile, "name" | "choices">} file */
export function fileRequest({ name, choices: { marks, ...others } }) {
  const motion_marks = Object.entries(marks).map(([motion, said]) => ({ motion: Number(motion), ...said }));
  return { name, ...others, motion_marks };
}

/**
 * What became of each file: the numbers of its demonstrations, counted on from the first one.
 * @param {ImportFile[]} files
 * @param {string} outcome of the job, e.g. "3-5"
 */
export function numbered(files, outcome) {
  let number = Number.parseInt(outcome, 10);
  return files.map(({ name, report }) => ({
    name,
    made: (report?.made ?? []).map((demonstration) => ({ ...demonstration, number: number++ })),
  }));
}
