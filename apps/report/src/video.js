// What both eyes saw, as a video on the page's clock.
import { hasBlock, rawBlock } from './data.js';
import { find } from './elements.js';
import { videoInWords } from './words.js';

const kAstray = 0.15;  // s that a video that plays may be beside the clock

export class Video {
  /** @param lasts  how long the trial is, whose video it is [s] */
  constructor(clock, about, lasts) {
    if (!about.video) return;
    this.element = find('video').querySelector('video');
    this.element.src = hasBlock('video')
      ? URL.createObjectURL(new Blob([rawBlock('video')], { type: 'video/mp4' }))
      : encodeURIComponent(about.video.file);
    this.element.addEventListener('loadedmetadata', () => {
      find('video').hidden = false;
      find('video-part').textContent = videoInWords(this.element.duration, lasts);
      this.follow(clock);
    });
    this.element.addEventListener('seeked', () => this.sought(clock));
    clock.onChange(() => this.follow(clock));
  }

  /** Goes on where the clock has moved while the video looked for another time. */
  sought(clock) {
    if (!clock.playing && clock.tick !== this.tick) this.follow(clock);
  }

  /** Played at the clock's speed and put right where it strays; else at the clock's time. Beyond its end its last picture stays. */
  follow(clock) {
    const video = this.element;
    const seconds = clock.tick / clock.rate;
    const end = video.duration || Infinity;  // not known before its metadata
    const left = end - seconds;
    const astray = Math.abs(video.currentTime - Math.min(seconds, end));
    if (!video.seeking && astray > (clock.playing ? kAstray : 0.001)) {
      video.currentTime = Math.min(seconds, end);
      this.tick = clock.tick;  // that it looks for
    }
    // One that has ended would begin anew.
    const plays = clock.playing && left > (video.ended ? kAstray : 0);
    if (plays && video.paused) {
      video.play().catch(() => {});
    } else if (!plays && !video.paused) {
      video.pause();
    }
    if (plays) video.playbackRate = Math.max(0.0625, clock.speed);
  }
}
