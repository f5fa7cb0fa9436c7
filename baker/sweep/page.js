// The slider between two pictures, and points of plots that put their picture into it.
const pictures = JSON.parse(document.getElementById("pictures").textContent);
const box = document.querySelector(".compare");
if (box) {
  const [left, right] = ["left", "right"].map((side) => ({
    image: box.querySelector("." + side), select: document.getElementById(side), about: document.getElementById("about-" + side)}));
  const show = (side) => {
    const picture = pictures[side.select.value];
    side.image.src = picture.uri;
    side.about.textContent = picture.about;
  };
  for (const side of [left, right]) side.select.addEventListener("change", () => show(side));
  box.querySelector("input").addEventListener("input", (event) => box.style.setProperty("--at", event.target.value + "%"));
  document.getElementById("difference").addEventListener("change", (event) => box.classList.toggle("difference", event.target.checked));
  for (const dot of document.querySelectorAll("[data-picture]"))
    dot.addEventListener("click", () => {
      if (!(dot.dataset.picture in pictures)) return;
      left.select.value = dot.dataset.picture;
      show(left);
      document.getElementById("look").scrollIntoView({behavior: "smooth"});
    });
}
