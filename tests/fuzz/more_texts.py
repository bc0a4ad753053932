"""Texts of other doors to be damaged: a step test with its CSV, a scene of TPCAP."""

STEP_TEST = """title: odd
model: vehicle
stop_time: 1 s
step: 10 ms
parameters: {driver: {reaction_delay: 0.1}}
inputs:
  steering_active: true
  steering_wheel_request: {step: {at: 0.2 s, to: 180 deg, from: 0}}
  prompt: {table: [[0, FORWARD], [0.5, STOP]]}
  manual.brake: {csv: {file: odd.csv, column: brake}}
  speed_request: {ramp: {begin: 0.1, end: 0.5, from: 0, to: 1 m/s}}
  speed_control_active: {pulse: {at: 0.1, width: 0.2, period: 0.5, to: true}}
  advised_speed: {sine: {amplitude: 0.5 m/s, frequency: 2 Hz, offset: 1, begin: 0}}
expect:
  - {id: a, signal: steering_wheel_angle, always: {max_abs: 200 deg}, from: 0.1 s, to: 1 s}
  - {id: b, signal: steering_wheel_angle, response: {rise_time: {max: 0.3 s}, to: 180 deg, at: 0.2 s, band: 0.02}}
  - {id: c, signal: speed, hold: {min: -1}, until: {max: 5, signal: pose.x}, from: 0}
  - {id: d, signal: speed, eventually: {max: 9}, within: 0.5 s, after: {signal: steering_wheel_request, min: 1 deg}}
"""
COLUMNS = """t,brake,speed
s,1,m/s
0,0,0
0.1,0,1
0.5,1,2
1,1,0
"""
SCENE = "0.1,0.2,0.3,4,5,1.57,2,4,3,1,1,2,1,2,2,1,2,7,7,8,7,8,8\n"
"""Start, goal, count of obstacles, their corners."""
