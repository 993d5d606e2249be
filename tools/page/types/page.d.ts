// Types that several modules of the page share.
import type { ArmStop } from "../../../clients/web/arm/stop.js";
import type { Editor as EditorClass } from "../../../clients/web/editor/editor.js";
import type { EventStream } from "../../../clients/web/event_stream.js";
import type { Messages } from "../../../clients/web/messages.js";
import type { Overlay } from "../../../clients/web/overlay.js";
import type { SceneLayers } from "../../../clients/web/scene_layers.js";
import type { Store } from "../../../clients/web/store.js";
import type { View } from "../../../clients/web/view.js";

declare global {
  /** x, y, z in robot coordinates [m], z up. */
  type Point = number[];

  /** What an element may hold; false, null, undefined and "" are left out. */
  type Child = Node | string | number | false | null | undefined | Child[];

  /** What the pointer or the keyboard is on. */
  type Focus = { kind: string; id: string };

  /** A running recording, as the topic `recordings` has it. */
  type ActiveRecording = { tracker: string; task: string; state: string; phase: string; received: number; lost: number };

  /** A pair without a value is left out. */
  type Fact = [name: string, value: string | number | false | null | undefined] | false | null | undefined;

  /** `verdict`: whether the arm can follow, in one line; `error`: why it cannot. */
  type PathSummary = { verdict?: string; facts?: Fact[]; error?: string; planning: boolean; planned: boolean };

  type ConnectionState = "connecting" | "live" | "lost" | "refused";
  type ConnectionDetails = { delay?: number; reason?: string };

  /** The state of the page; store.js says what is what. */
  type State = {
    connection: string;
    tasks: Task[] | null;
    task: string;
    demonstrations: Demonstration[] | null;
    runs: RunSummary[] | null;
    selectedRun: Run | null;
    jobs: Job[] | null;
    executions: Execution[] | null;
    recordings: ActiveRecording[];
    trackers: { name: string }[];
    guidance: Record<string, string>;
    station: { notes: string[]; authority: boolean; documents: boolean; name: string; display_name: string } | null;
    shownStation: string | null;
    executor: ExecutorStatus | null;
    lease: LeaseState | null;
    identity: Identity;
    run: string;
    path: string;
    plan: Plan | null;
    focus: Focus | null;
    trajectoriesLoaded: number;
    latestVersions: Record<string, LearnedPath>;
    pathSummaries: Record<string, PathSummary>;
  };

  type Changed = Set<string>;

  /** What panels and sections are given. */
  type Context = {
    store: Store;
    eventStream: EventStream;
    view: View;
    sceneLayers: SceneLayers;
    overlay: Overlay;
    messages: Messages;
    /** Nothing can be ordered: a review package. */
    readOnly: boolean;
    attempt<T>(order: () => T | Promise<T>): Promise<T | undefined>;
    open(id: string): void;
    armStop: ArmStop;
  };

  type Section = { update(state: State, changed: Changed): void; show?(): void; hide?(): void };

  type Panel = Section & { id: string; title: string; mount(element: HTMLElement, context: Context): void };

  type Editor = EditorClass;

  /** What has changed in the editor, see editor.js. */
  type EditorChange = "draft" | "curve" | "selection" | "drag" | "versions" | "feasibility" | "planning";

  type EditorSection = { update(editor: Editor, what: EditorChange): void };

  /** The hand at one moment; orientation w, x, y, z, or null where it is not measured. */
  type Hand = {
    position: Point;
    orientation: number[] | null;
    tracked: boolean;
    grasp: boolean;
    clutch?: boolean;
  };

  /** A hand with the page's clock [ms] and the seconds since the sample before. */
  type HandSample = Hand & { ms: number; seconds?: number };

  /** What the controls of a hand ask and order. */
  type HandActions = { canGrasp(): boolean; grasp(): void; release(): void };
}
