// What the server and the page say to each other: see source.hpp, live_session.hpp, recording.hpp
// and board_session.hpp of host/viewer.

export type Triple = [number, number, number];
export type Range = [number, number];

export interface Settings {
  stiffness_N_m: number;
  damping_Ns_m: number;
  static_friction: number;
  dynamic_friction: number;
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
  models: { name: string; points: number }[];
  // of a simulation
  devices?: { name: string; about: string }[];
  injections?: { fault: string; about: string }[];
  has_materials?: boolean;
  settings?: Settings;
  // of a board
  port?: string;
  // of a trace
  ticks?: number;
  overview?: { force_N: Range[]; penetration_m: Range[] };
}

/** One controller in one tick. */
export interface Run {
  mode: string;
  state: string;
  faults: { code: number; name: string }[];
  limits: string[];
  overruns: number;
  t_s: number;
  probe_m: Triple;
  proxy_m: Triple;
  normal: Triple;
  force_N: Triple;
  velocity_m_s: Triple;
  penetration_m: number;
  in_contact: boolean;
  slipping: boolean | null; // null: a board does not tell
  strength: number;
  tip_m: Triple | null; // likewise
  linkage: Triple[][];
  candidates: Triple[];
  strip?: {
    ticks: number;
    force_N: Range;
    penetration_m: Range;
    work: Range | null;
  };
}

/** A board, and the connection to it. */
export interface Board {
  name: string;
  firmware: string;
  link: 'here' | 'gone' | 'taken';
  why: string; // it is not here
  model: 'same' | 'other' | 'unknown';
  about_model: string;
  confirm: string; // what the person at the device has to do now
  load: number;
  dropped: number;
}

export interface Frame {
  type: 'frame';
  t_s: number;
  runs: Run[];
  bodies: number[][];
  /** What the strips' work is counted in; empty: it is not known. `why` something is missing. */
  work: { unit: string; bound: number | null; why: string };
  // of a simulation
  hand_m?: Triple;
  lost_s?: number;
  settings?: Settings;
  // of a board, with settings
  board?: Board;
  news?: { number: number; text: string };
  // of a trace
  tick?: number;
  playing?: number;
  around?: { first: number; force_N: number[]; penetration_m: number[] };
}

export type Command = { do: string; [key: string]: unknown };

export const length = (v: Triple): number => Math.hypot(v[0], v[1], v[2]);
