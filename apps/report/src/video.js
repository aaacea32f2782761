// What both eyes saw, as a video on the page's clock.
import { hasBlock, rawBlock } from './data.js';
import { find } from './elements.js';

export class Video {
  constructor(clock, about) {
    if (!about.video) return;
    this.element = find('video').querySelector('video');
    this.element.src = hasBlock('video')
      ? URL.createObjectURL(new Blob([rawBlock('video')], { type: 'video/mp4' }))
      : encodeURIComponent(about.video.file);
    this.element.addEventListener('loadedmetadata', () => {
      find('video').hidden = false;
      this.follow(clock);
    });
    clock.onChange(() => this.follow(clock));
  }

  /** Played at the clock's speed and put right where it strays; else at the clock's time. */
  follow(clock) {
    const video = this.element;
    const seconds = clock.tick / clock.rate;
    if (clock.playing && video.paused) {
      video.playbackRate = Math.max(0.0625, clock.speed);
      video.play().catch(() => {});
    } else if (!clock.playing && !video.paused) {
      video.pause();
    }
    if (clock.playing) video.playbackRate = Math.max(0.0625, clock.speed);
    const astray = Math.abs(video.currentTime - seconds);
    if (!video.seeking && astray > (clock.playing ? 0.15 : 0.001)) {
      video.currentTime = Math.min(seconds, video.duration || seconds);
    }
  }
}
