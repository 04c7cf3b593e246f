"""The commands: ``tissue run`` and ``tissue movie``; the others have files of their own."""

from __future__ import annotations

import platform
import time
from importlib.metadata import version
from pathlib import Path
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Annotated
from warnings import warn

import typer

from dincl.errors import InvalidProblem
from dincl.files import check_writable, write_text
from dincl.study import progress
from tissue.cli.fits import fit, sensitivity
from tissue.cli.messages import RUN_FAILED, messages
from tissue.cli.parameters import list_parameters
from tissue.cli.studies import page, simplify, study, summarise
from tissue.files.parameter_files import BASES, PRESETS

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters
    from tissue.frames.frame import Frame
    from tissue.runs.run import Run


# The page shows tissues and inclusions, so it stands above this package, which knows nothing of it but this name.
PAGE = "verification.explore.command:explore"
WRITTEN = ("table.parquet", "summary.csv", "columns.csv", "parameters.toml", "picture.png", "final.npz")
HELP = {"help_option_names": ["-h", "--help"]}
app = typer.Typer(
    help="Grow a tissue, and look at it.", no_args_is_help=True, rich_markup_mode="markdown", context_settings=HELP
)
app.command()(resolve_name(PAGE))
app.command()(study)
app.command()(page)
app.command()(simplify)
app.command()(fit)
app.command()(sensitivity)
app.command("parameters")(list_parameters)
app.command("summary")(summarise)
File = Annotated[str, typer.Argument(metavar="FILE", help=f"A parameter file, or a preset: {', '.join(PRESETS)}.")]
Seed = Annotated[int, typer.Option(min=0, help="The run is a function of the parameters and this.")]


@app.command()
def run(
    file: File,
    seed: Seed = 0,
    out: Annotated[
        Path | None,
        typer.Option(help="Folder to write to: new, or of the same run.", show_default="results/FILE_seedSEED"),
    ] = None,
    start: Annotated[
        Path | None, typer.Option(help="The final.npz of a run to go on from.", show_default="t = 0")
    ] = None,
) -> None:
    """Simulate; write table.parquet, summary.csv, columns.csv, which says what their columns mean, parameters.toml,
    picture.png and the last state, final.npz.

    A parameter file names a base, such as base = "thesis", and what differs: "tissue parameters" lists all keys.
    The first run on a machine takes longer: the kernels are compiled.
    """
    from pyarrow import Table

    from dincl.study.sealed import write_arrow
    from dincl.study.table import write_csv
    from tissue.frames.frame import Frame
    from tissue.frames.observables import measurable
    from tissue.pictures.picture import drawing
    from tissue.pictures.sheet import write
    from tissue.runs.columns import dictionary, labelled

    with messages():
        parameters = _parameters(file)
        folder = out or Path("results") / f"{Path(file).stem}_seed{seed}"
        first = Frame.load(start) if start else None
        after = f" --start {str(start)!r}" if start else ""
        text = _checked_parameters(parameters, file, f"--seed {seed}{after}", folder)
        grown = _simulated(parameters, seed, first)
        write_text(folder / "parameters.toml", text)
        cells, summary = grown.table(), grown.summary()
        of_cells = labelled(Table.from_pandas(cells, preserve_index=False), "table", {"seed": seed})
        write_arrow(of_cells, folder / "table.parquet")
        write_csv(summary, folder / "summary.csv")
        write_csv(dictionary({"table": cells, "summary": summary}), folder / "columns.csv")
        write(drawing(measurable(grown.frames)[-1], parameters), folder / "picture.png")
        if grown.status:  # from the state that failed no run goes on
            grown.final.save(folder / "final.npz")
    print(f"{folder}: {', '.join(WRITTEN if grown.status else WRITTEN[:-1])}")
    _stop_if_failed(grown)


@app.command()
def movie(
    file: File,
    seed: Seed = 0,
    out: Annotated[Path, typer.Option(help="Where to write; .gif or .webp.")] = Path("movie.gif"),
    keep: Annotated[
        str | None,
        typer.Option(metavar="TIME", help='Time between two pictures, such as "0.5 h".', show_default="as in FILE"),
    ] = None,
    flat: Annotated[bool, typer.Option("--section", help="In three dimensions: a section in place of a view.")] = False,
) -> None:
    """Simulate, and write an animation of the saved states; in three dimensions of nuclei below the apical surface.

    The view needs the extra "views"; without it the movie shows a section.
    """
    from tissue.frames.observables import measurable
    from tissue.pictures import movie as film
    from tissue.pictures import space

    with messages():
        film.ending(out)
        parameters = _parameters(file)
        if keep is not None:
            parameters = parameters.changed({"numerics.keep": keep})
        draw = film.movie if flat or not parameters.in_space else space.view
        if draw is space.view:
            try:
                space.load_library()
            except InvalidProblem as missing:
                warn(f"{missing}; the movie shows a section", stacklevel=1)
                draw = film.movie
        out.parent.mkdir(parents=True, exist_ok=True)
        check_writable(out)
        grown = _simulated(parameters, seed)
        frames = measurable(grown.frames)
        with progress("drawing", len(frames), "pictures") as watch:
            draw(frames, parameters, out, watch)
    print(f"{out}: {len(frames)} pictures, {out.stat().st_size / 1e6:.1f} MB")
    _stop_if_failed(grown)


def _parameters(file: str) -> Parameters:
    from tissue.files.parameters import load, preset

    if file in PRESETS:
        return preset(file)
    if not Path(file).exists():
        raise InvalidProblem(f"{file}: there is no such file; must be a TOML file, or a preset, {BASES}")
    return load(file)


def _checked_parameters(parameters: Parameters, file: str, given: str, folder: Path) -> str:
    """Return the complete parameters, and what else it takes to repeat the run; refuse the folder of another run.

    ``given``: the options on which the run depends.
    """
    from tissue.study.store import refuse_study

    refuse_study(folder)
    folder.mkdir(parents=True, exist_ok=True)
    path, text = folder / "parameters.toml", parameters.as_toml()
    if names := sorted(set(WRITTEN) & {one.name for one in folder.iterdir()}):
        before = path.read_text("utf-8", "replace") if path.is_file() else ""
        if f" {given}\n" not in before.partition("# Made by")[0] or not before.endswith(f"\n\n{text}"):
            allowed = "must be new, or the folder of the same run"
            raise InvalidProblem(f"{folder}: {allowed}; it holds {', '.join(names)} of another one")
    made_by = ", ".join(f"{name} {version(name)}" for name in ("dincl-testbed", "numpy", "numba"))
    made_on = f"# Made by {made_by}, Python {platform.python_version()} on {platform.machine()}"
    return f"# All parameters of: tissue run {file!r} {given}\n{made_on}\n\n{text}"


def _simulated(parameters: Parameters, seed: int, first: Frame | None = None) -> Run:
    from tissue.runs.simulate import simulate

    if first is not None and abs(parameters.t_end - first.t) < parameters.numerics.dt.value / 2:
        end = f"the start is at t = {first.t:g} h, and numerics.t_end = {parameters.t_end:g} h"
        warn(f"nothing to grow: {end}", stacklevel=1)
    began = time.monotonic()
    with progress("growing", parameters.t_end, "h") as watch:
        grown = simulate(parameters, seed, start=first, throw=False, watch=watch)
    counts = f"{len(grown.frames[0].cells.x)} cells became {len(grown.final.cells.x)}"
    print(f"{grown.final.t:g} h in {time.monotonic() - began:.2f} s, {counts}")
    return grown


def _stop_if_failed(grown: Run) -> None:
    if not grown.status:
        typer.echo(f"Failed: {grown.status.value} {grown.detail}", err=True)
        raise typer.Exit(RUN_FAILED)
