// A headset that IWER emulates, a person who wears it, and a clock that waits for the drawing. All of it
// runs in the page.
//
// Of IWER 2.5.0: its frames come with those of the page, and their predictedDisplayTime is the callback's time.
// Select events come just before the callback of the same frame. `emulatedPosition` is always true. A grip is
// placed from the ray that a test moves; that of a bare hand moves when it pinches. Both views see the same angles.

/** Each frame of the page takes 1/hz s of the page's clock, as long as drawing it may take. */
export function stepClock({ hz }) {
  let now = 1000;
  const real = window.requestAnimationFrame.bind(window);
  performance.now = () => now;
  window.requestAnimationFrame = (callback) => real(() => callback(now));
  /** The next frame comes so much later [ms]. */
  window.comeLate = (by) => { now += by; };
  const step = () => {
    now += 1000 / hz;
    real(step);
  };
  real(step);
}

/** A headset, and somebody who wears it. */
export function wear({ inputs, ahead = 0 }) {
  const device = new window.IWER.XRDevice(window.IWER.metaQuest3);
  device.installRuntime({ forceInstall: true });  // over Chromium's own, which has no headset
  if (ahead > 0) {  // poses are predicted by so much [ms]
    const { get } = Object.getOwnPropertyDescriptor(XRFrame.prototype, 'predictedDisplayTime');
    Object.defineProperty(XRFrame.prototype, 'predictedDisplayTime', { get() { return get.call(this) + ahead; } });
  }
  device.primaryInputMode = inputs;
  device.stereoEnabled = true;
  for (const hand of ['left', 'right']) device.hands[hand].poseId = 'pinch';  // a grip that stays when it pinches

  const times = (a, b) => [
    a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
    a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]];
  const back = ([w, x, y, z]) => [w, -x, -y, -z];
  const turned = (q, p) => times(times(q, [0, ...p]), back(q)).slice(1);
  const put = (object, q, p) => {
    object.position.set(...p);
    object.quaternion.set(q[1], q[2], q[3], q[0]);
  };

  // The wearer stands somewhere in the room and looks to the side: the page has to recentre.
  let yaw;
  let stands;
  const inRoom = (p) => turned(yaw, p).map((x, i) => x + stands[i]);
  const stand = (turn, [x, z]) => {
    yaw = [Math.cos(turn / 2), 0, Math.sin(turn / 2), 0];
    stands = [x, 0, z];
    put(device, yaw, inRoom([0, 1.7, 0]));
  };
  stand(0.5, [0.4, -0.3]);

  const input = (hand) => (inputs === 'hand' ? device.hands[hand] : device.controllers[hand]);
  const press = (hand, down) => (inputs === 'hand' ? input(hand).updatePinchValue(down ? 1 : 0)
    : input(hand).updateButtonValue('trigger', down ? 1 : 0));

  /** Moves a hand: its axes as those of the room, its place p in T. */
  const move = (hand, p, grip) => {
    const q_HS = hand === 'left' ? [0.5, 0.5, -0.5, -0.5] : [0.5, 0.5, 0.5, 0.5];
    const q = times(times(yaw, q_HS), back(grip.q));
    const off = turned(q, grip.p);
    put(input(hand), q, inRoom(p).map((x, i) => x - off[i]));
  };

  /** Where a grip is seen from the ray that it belongs to. */
  const gripOf = (hand) => new Promise((resolve) => {
    const { session, floor } = window.headpin.xr;
    const look = (time, frame) => {
      const source = [...session.inputSources].find(({ handedness }) => handedness === hand);
      if (!source) return session.requestAnimationFrame(look);
      const [ray, grip] = [source.targetRaySpace, source.gripSpace].map((space) => {
        const { position: { x, y, z }, orientation: o } = frame.getPose(space, floor).transform;
        return { p: [x, y, z], q: [o.w, o.x, o.y, o.z] };
      });
      return resolve({ q: times(back(ray.q), grip.q), p: turned(back(ray.q), grip.p.map((x, i) => x - ray.p[i])) });
    };
    session.requestAnimationFrame(look);
  });

  /** Calls `at(seconds)` before each frame until it gives true. */
  const during = (at) => new Promise((resolve) => {
    let start;
    const step = (time) => {
      start ??= time;
      if (at((time - start) / 1e3)) resolve();
      else requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  });

  const smooth = (x) => (x <= 0 ? 0 : x >= 1 ? 1 : x ** 3 * (10 + x * (6 * x - 15)));
  const inT = ([x, y, z]) => {
    const [, , , , ox, oy] = window.headpin.game.X_WT;
    return [x - ox, z, -(y - oy)];
  };

  /** Touches a place of the world with the open hand. */
  const touch = async (hand, place) => {
    const grip = await gripOf(hand);
    const to = inT(place);
    const away = (far) => move(hand, [to[0], to[1], to[2] + 0.4 * far], grip);
    await during((t) => {
      away(1 - smooth(t));
      return t > 1.1;
    });
    await during((t) => {
      away(smooth(t));
      return t > 1.1;
    });
  };

  /** Takes the ball, swings it back and then along the lane at 16 m/s2, and lets it go after 0.4 s. */
  const throwBall = async (hand) => {
    const { game, json } = window.headpin;
    const grip = await gripOf(hand);
    const [right, ...rest] = json.ball.homes[0];
    const home = [hand === 'left' ? -right : right, ...rest];
    const reach = (ball) => move(hand, inT(ball).map((x, i) => x - game.grip[i]), grip);
    await during((t) => {
      reach(home.map((x, i) => x + [0, -0.3, 0.4][i] * (1 - smooth(t))));
      return t > 1.1;
    });
    press(hand, true);
    await during(() => {
      reach(home);
      return game.view[4] > 0;
    });
    let on = true;
    await during((t) => {
      const low = smooth(t / 0.8);
      const s = Math.max(0, t - 0.8);
      reach([(1 - low) * home[0], home[1] - 1.2 * low + 8 * Math.min(s, 0.6) ** 2, home[2] - 0.6 * low]);
      if (on && s >= 0.4) press(hand, on = false);
      return s > 1;
    });
  };

  /** What the wearer sees of both eyes: for each, colours of a grid of pixels. */
  const seen = () => new Promise((resolve) => {
    const { session } = window.headpin.xr;
    const look = () => {
      const { baseLayer: { context: gl } } = session.renderState;
      const [width, height] = [gl.drawingBufferWidth / 2, gl.drawingBufferHeight];
      resolve([0, 1].map((eye) => {
        const pixels = new Uint8Array(4 * width * height);
        gl.readPixels(eye * width, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
        return [...pixels];
      }));
    };
    session.requestAnimationFrame(look);  // after the page's own callback of the same frame
  });

  window.worn = { device, stand, touch, throwBall, during, seen };
}
