// The service counts joints in its sentences; the page calls them as the arm's model does.

/**
 * A sentence of the service with the joints of the station's arm by name; as it is while the arm is not known.
 * @param {string} sentence
 * @param {Robot | null} robot
 */
export function nameJoints(sentence, robot) {
  return sentence.replace(/\bjoint (\d+)\b/g, (counted, number) => robot?.joints[Number(number) - 1]?.name ?? counted);
}

/**
 * Where a certificate says that a limit is nearest; the joints of another arm than the station's stay counted.
 * @param {string} place
 * @param {Pick<Certificate, "signature">} certificate
 * @param {Robot | null} robot
 */
export function namePlace(place, { signature }, robot) {
  return nameJoints(place, signature?.arm === armTitle(robot) ? robot : null);
}

/** What certificates call the station's arm: its name, of one that was added with the begin of its hash. @param {Robot | null} robot */
const armTitle = (robot) => robot && (robot.model ? `${robot.variant} (${robot.model.slice(0, 12)})` : robot.variant);
