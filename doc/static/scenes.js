/* Load a 3D scene when it comes into view: browsers load lazy frames from far away, which holds up the page. */
const watcher = new IntersectionObserver((entries) => {
  for (const { isIntersecting, target } of entries) {
    if (isIntersecting) {
      target.src = target.dataset.src;
      watcher.unobserve(target);
    }
  }
});
addEventListener("load", () => document.querySelectorAll("iframe.scene").forEach((one) => watcher.observe(one)));
