// Messages between server and page, documented in source.hpp, live_session.hpp, recording.hpp and
// board_session.hpp of host/viewer.

export type Triple = [number, number, number];
export type Range = [number, number];

export interface Settings {
  stiffness_N_m: number;
  damping_Ns_m: number;
  static_friction: number;
  dynamic_friction: number;
  texture_height_m: number;
  texture_wavelength_m: number;
  rate_hz: number;
  use_materials: boolean;
  stiffness_limit_N_m: number;
  force_max_N: number;
  // of a simulation
  mode?: 'surface' | 'paper' | 'both';
  device?: string;
  // of a board
  force_limit_N?: number;
}

export interface Hello {
  type: 'hello';
  source: 'simulation' | 'trace' | 'board';
  models: { name: string; points: number; note: string }[]; // note: a doubt about it, or ''
  // of a simulation
  devices?: { name: string; about: string }[];
  injections?: { fault: string; about: string }[];
  has_materials?: boolean;
  hand_start_m?: Triple;
  settings?: Settings;
  // of a board
  port?: string;
  // of a trace
  ticks?: number;
  begin_s?: number;
  end_s?: number;
  overview?: { force_N: Range[]; penetration_m: Range[] };
}

/** State of one controller in one tick. */
export interface Run {
  mode: string;
  state: string;
  faults: { code: number; name: string; about?: string }[];
  note?: string; // why there is no force although the controller is active, or ''
  limits: string[];
  overruns: number;
  t_s: number;
  probe_m: Triple;
  proxy_m: Triple;
  normal: Triple;
  force_N: Triple;
  motor_force_N?: Triple; // everything that the motors are told; missing: unknown
  gravity_force_N?: Triple;
  added_force_N?: Triple;
  velocity_m_s: Triple;
  penetration_m: number;
  in_contact: boolean;
  slipping: boolean | null; // null: not reported by boards
  strength: number;
  tip_m: Triple | null; // null: not reported by boards
  linkage: Triple[][];
  candidates: Triple[];
  strip?: { ticks: number; force_N: Range; penetration_m: Range; work: Range | null };
}

/** A board, and the connection to it. */
export interface Board {
  name: string;
  firmware: string;
  link: 'here' | 'gone' | 'taken';
  why: string; // cause of a lost connection
  watch_only: boolean; // operated by its button, or shared: the page may watch and stop
  shared: boolean; // by tactree serve, whose programs command it
  model: 'same' | 'other' | 'unknown';
  about_model: string;
  confirm: string; // action required at the device to finish arming; empty: none
  load: number;
  dropped: number;
}

/** A recording of the board in a file, as of `tactree record`. */
export interface Recording {
  state: 'off' | 'on' | 'completing';
  text: string; // file and counts of this or the last recording
}

/** The model in the frame of the device: device = pose * (scale * model), as in a pose file. */
export interface Placement {
  pose: number[]; // a 4x4 matrix, row by row
  scale: number;
}
export interface Place extends Placement {
  origin_m: Triple; // of the scene, in the frame of the device
  hand_start_m?: Triple; // of a simulation
}

export interface Frame {
  type: 'frame';
  t_s: number;
  runs: Run[];
  bodies: number[][];
  /** Work per tick. `unit` is empty when it is unknown; `why` names the cause of a missing value. */
  work: { unit: string; bound: number | null; why: string };
  // of a simulation
  hand_m?: Triple;
  lost_s?: number;
  fit?: { warning: string; can_scale: boolean };
  settings?: Settings;
  // of a single model that can be placed
  place?: Place;
  // of a simulation or a board: a result that the other values do not show
  news?: { number: number; text: string };
  // of a board, with settings
  board?: Board;
  recording?: Recording;
  // of a trace
  tick?: number;
  playing?: number;
  around?: { first: number; force_N: number[]; penetration_m: number[] };
}

export type Command = { do: string; [key: string]: unknown };

export const length = (v: Triple): number => Math.hypot(v[0], v[1], v[2]);
