// Whether a headset's frame is drawn. Samples come with the frames, and a frame waits for the picture before it: where
// drawing is slow, samples come first, and no picture tears a hole into a take.
const LATE = 40; // [ms] between two frames that no headset has by itself
const HOLE = 90; // [ms] without a sample; a take of which a picture may cost that much gets none
const SELDOM = 10_000; // [ms] between two pictures where each tears such a hole
const SPARING = 4; // times what a picture costs lie between two of them, where they make frames late
const FORGET = 0.995; // with every frame in time

export class Pictures {
  #before = null; // [ms] the frame before
  #drawn = -Infinity; // [ms] the newest picture
  cost = 0; // [ms] what a picture seems to cost

  // `time` of the frame [ms]; `busy`: a take is under way or may begin at any moment.
  affords(time, busy) {
    const apart = time - (this.#before ?? time);
    this.#before = time;
    if (apart > LATE) this.cost = Math.max(apart, this.cost);
    else if (!busy) this.cost *= FORGET; // what was dear before the take stays dear to its end
    const dear = this.cost > HOLE;
    const least = dear ? SELDOM : this.cost > LATE ? SPARING * this.cost : 0;
    if ((dear && busy) || time - this.#drawn < least) return false;
    this.#drawn = time;
    return true;
  }
}
