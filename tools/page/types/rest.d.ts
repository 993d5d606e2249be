// The documents of the REST API, by the names of its own description (api.d.ts, which is generated from it).
import type { components } from "./api";

type Schemas = components["schemas"];

declare global {
  type Adaptation = Schemas["Adaptation"];
  type AdaptationModel = Schemas["AdaptationModel"];
  type Assessment = Schemas["Assessment"];
  type Certificate = Schemas["Certificate"];
  type Calibration = Schemas["Calibration"];
  type Cluster = Schemas["Cluster"];
  type Curve = Schemas["Curve"];
  type Cut = Schemas["Cut"];
  type Demonstration = Schemas["Demonstration"];
  type Dendrogram = Schemas["Dendrogram"];
  type EditResult = Schemas["EditResult"];
  type Execution = Schemas["Execution"];
  type ExecutorStatus = Schemas["ExecutorStatus"];
  type FileReport = Schemas["FileReport"];
  type Identity = Schemas["Identity"];
  type Job = Schemas["Job"];
  type LearnedPath = Schemas["LearnedPath"];
  type ListedPerson = Schemas["ListedPerson"];
  type ListedToken = Schemas["ListedToken"];
  type LeaseState = Schemas["Lease"];
  type JointGeometry = Schemas["JointGeometry"];
  type MeasuredCalibration = Schemas["MeasuredCalibration"];
  type MeshHull = Schemas["MeshHull"];
  type MotionPreview = Schemas["MotionPreview"];
  type Plan = Schemas["Plan"];
  type PlanSummary = Schemas["PlanSummary"];
  type RecordingReport = Schemas["Ended"];
  type Robot = Schemas["Robot"];
  type Run = Schemas["Run"];
  type RunSummary = Schemas["RunSummary"];
  type SavedScene = Schemas["SavedScene"];
  type SavedVersion = Schemas["SavedVersion"];
  type Scene = Schemas["Scene"];
  type SceneVersion = Schemas["SceneVersion"];
  type Score = Schemas["Score"];
  type Shape = Schemas["Shape"];
  type StreamStatistics = Schemas["StreamStatistics"];
  type Task = Schemas["Task"];
  type TimeSeries = Schemas["TimeSeries"];
  type TrackerState = Schemas["Tracker"];
  type TouchedPlace = Schemas["Touch"];
  type Version = Schemas["Version"];
}
