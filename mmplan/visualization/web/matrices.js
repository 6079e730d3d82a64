"use strict";
// Matrices are 16 numbers column by column, as WebGL takes them; poses are 7 numbers:
// position (m) and quaternion x, y, z, w.

const IDENTITY = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);

function product(a, b) {
  const c = new Float32Array(16);
  for (let column = 0; column < 4; column++)
    for (let row = 0; row < 4; row++)
      for (let k = 0; k < 4; k++) c[4 * column + row] += a[4 * k + row] * b[4 * column + k];
  return c;
}

function poseMatrix(p) {
  const [x, y, z, qx, qy, qz, qw] = p;
  return new Float32Array([
    1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy + qz * qw), 2 * (qx * qz - qy * qw), 0,
    2 * (qx * qy - qz * qw), 1 - 2 * (qx * qx + qz * qz), 2 * (qy * qz + qx * qw), 0,
    2 * (qx * qz + qy * qw), 2 * (qy * qz - qx * qw), 1 - 2 * (qx * qx + qy * qy), 0,
    x, y, z, 1]);
}

// A pose between two, which lie near each other.
function blended(a, b, share) {
  let along = 0;
  for (let k = 3; k < 7; k++) along += a[k] * b[k];
  const sign = along < 0 ? -1 : 1;
  const pose = [];
  for (let k = 0; k < 7; k++) pose.push((1 - share) * a[k] + share * (k < 3 ? 1 : sign) * b[k]);
  const length = Math.hypot(...pose.slice(3));
  return pose.map((value, k) => (k < 3 ? value : value / length));
}

function perspective(degrees, aspect, near, far) {
  const f = 1 / Math.tan((degrees * Math.PI) / 360);
  const m = new Float32Array(16);
  m[0] = f / aspect;
  m[5] = f;
  m[10] = (far + near) / (near - far);
  m[11] = -1;
  m[14] = (2 * far * near) / (near - far);
  return m;
}

const minus = (a, b) => a.map((value, k) => value - b[k]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((value) => value / (Math.hypot(...a) || 1));

function looking(eye, target) {
  const back = unit(minus(eye, target));
  const right = unit(cross([0, 0, 1], back));
  const up = cross(back, right);
  return new Float32Array([
    right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
    -dot(right, eye), -dot(up, eye), -dot(back, eye), 1]);
}

// What puts a pipe of length and radius 1 along z between two points.
function between(a, b, radius) {
  const along = minus(b, a);
  const z = unit(along);
  const helper = Math.abs(z[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0];
  const x = unit(cross(helper, z));
  const y = cross(z, x);
  const s = (v, f) => v.map((value) => value * f);
  return new Float32Array([
    ...s(x, radius), 0, ...s(y, radius), 0, ...s(z, Math.hypot(...along)), 0, ...a, 1]);
}

function disc(x, y, z, radius) {
  return new Float32Array([radius, 0, 0, 0, 0, radius, 0, 0, 0, 0, 0.004, 0, x, y, z, 1]);
}
