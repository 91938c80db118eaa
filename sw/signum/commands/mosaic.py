# SPDX-License-Identifier: Apache-2.0
"""`signum mosaic`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import closing
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from signum.applications.mosaic.accuracy import accuracy_rows, pose_errors
from signum.applications.mosaic.journal import SurveyRun
from signum.applications.mosaic.recorded import BATCH, RecordedSurvey, check_batch
from signum.applications.mosaic.settings import CURVED, SurveySettings
from signum.applications.mosaic.shelf import find_survey, has_journal, read_record, survey_files
from signum.applications.mosaic.survey import Survey
from signum.applications.mosaic.track import TimedTrack, Track
from signum.applications.mosaic.track_reader import read_track
from signum.applications.mosaic.ways import WAYS
from signum.commands.app import command
from signum.commands.crew import BatchOptions
from signum.commands.ground import GroundOptions
from signum.commands.options import SOURCE, BoardOptions, CalibrationOption, OutOption
from signum.commands.outputs import PAGE, move_aside, page_trouble
from signum.commands.session import Session, kind_of
from signum.commands.signals import shielded
from signum.common.console import notes, out, progress
from signum.common.errors import SignumError
from signum.common.files import real_path, replacing
from signum.frames.frame import Frame
from signum.measure.register import Registrar
from signum.tables.schemas import ACCURACY
from signum.tables.table import Table

LIVE_EVERY = 2.0
"""Seconds between two pictures of the growing mosaic."""
BOARD_DEFAULTS = BoardOptions(sigma=2.5)


class TrackKind(StrEnum):
    """How a survey was flown."""

    auto = "auto"
    single = "single"
    turned = "turned"


GROUND_DEFAULTS = GroundOptions()
BATCH_DEFAULTS = BatchOptions()


@command()
def mosaic(
    source: Annotated[str, typer.Argument(help="Folder of overlapping pictures, video, ROS bag, .npy array or camera "
                                          "number.", show_default=False)],
    calibration: CalibrationOption = None,
    output: OutOption = Path("out/mosaic"),
    board: BoardOptions = BOARD_DEFAULTS,
    ground: GroundOptions = GROUND_DEFAULTS,
    batch: BatchOptions = BATCH_DEFAULTS,
    columns: Annotated[TrackKind, typer.Option(
        "--columns", help="auto: any track, all neighbours linked and placed by least squares; single: each frame "
        "against the one before only; turned: as auto, for a camera turned in place, whose distorted loops are closed.")
                       ] = TrackKind.auto,
    truth: Annotated[Path | None, typer.Option(
        "--truth", help="CSV with frame and east_m, north_m (or x_px, y_px), and heading_deg if known: errors of the "
        "poses go to accuracy.csv.")] = None,
    resume: Annotated[bool | None, typer.Option(
        "--resume/--anew", help="Continue the survey in --out with these frames, from wherever they are; or move --out "
        "aside, to a name that ends in -1, and start anew. By default the survey of the same source is continued.",
        show_default=False)] = None,
    rate: Annotated[float | None, typer.Option(
        "--rate", rich_help_panel=SOURCE, min=0.001, max=1000.0, help="Frames per second of a source whose frames have "
        "no times, for a --navigation log by time.", show_default=False)] = None,
    water: Annotated[bool, typer.Option("--water/--no-water", help="Take the tint of the water out of the mosaic of "
                                        "colour pictures: grey on average, and bright.")] = False,
    live: Annotated[bool, typer.Option("--live/--no-live", help="Write mosaic.png every few seconds as it grows.")
                    ] = True,
) -> None:
    """Mosaic of a survey, whatever its track: `mosaic.png`, `poses.csv`, `edges.csv`, `report.html`, and with a scale
    `mosaic.tif`. It grows while frames come; after an interrupt the same call continues it.

    Example: `signum mosaic survey/ --out out/mosaic`
    """
    settings = CURVED if columns is TrackKind.turned else SurveySettings(loops=columns is TrackKind.auto)
    session = Session("mosaic", board, output, source, calibration, rate)
    known = None if truth is None else read_track(truth, session.source.label)
    place = ground.known(session.source, calibration, lambda: session.first.size)
    with session as run:
        if isinstance(place.log, TimedTrack) and run.first.time_s is None:
            raise SignumError(f"{ground.navigation}: is by time, and {run.source.label} has frames without times: give "
                              "their --rate, or a log by frame")
        if batch.wanted:
            check_batch(not run.source.snapshots, run.live, run.source.label)
        asked = SurveyRun(run.name, run.fit.source, not run.source.snapshots, board.window, board.sigma,
                          settings.columns, "" if calibration is None else str(real_path(calibration)),
                          BATCH if batch.wanted else "")
        registrar = Registrar.on(run.measurer, run.fit, board.window, board.sigma)
        resumes = _resumes(resume, run, asked, [p for p in (calibration, truth, ground.navigation) if p is not None])
        crew = run.open(batch.crew(output, str(board.board), asked))
        survey = (RecordedSurvey(registrar, output, settings, asked.source, resumes, asked.calibration, crew)
                  if batch.wanted else
                  Survey(registrar, output, asked.stream, settings, asked.source, resumes,
                         LIVE_EVERY if live else float("inf"), asked.calibration))
        survey.results.ground = place.placing(lambda: survey.ledger.shelf.begun_s)
        survey.results.cog, survey.results.water = ground.cog, water
        _grow(run, survey, known)
    if survey.results.trouble:
        raise SignumError(survey.results.trouble)


class _Frames:
    """The frames of a session, each time anew where the source can give them again."""

    def __init__(self, run: Session) -> None:
        self._run, self._begun = run, False

    def __iter__(self) -> Iterator[Frame]:
        again, self._begun = self._begun, True
        return self._run.frames_again() if again else self._run.frames()


def _grow(run: Session, survey: Survey, known: Track | None) -> None:
    """All frames, then all neighbours; what was placed is blended and reported, also after a bad frame. After an
    interrupt, or where a file cannot be written, the pictures are left to the next call."""
    finished = stopped = False

    def close() -> None:
        if stopped:
            survey.leave()
            return
        with progress("blending", None) as survey.results.told:
            survey.close(finished)
        if known is not None and finished:
            _judge(survey, known)

    def report() -> None:
        if not stopped and survey.shown:
            run.refused = Counter(kind_of(edge.reason) for edge in survey.edges if not edge.accepted)
            run.report_folder()
            if finished:
                survey.mark_finished()

    run.at_end(close)
    run.report, run.result = report, survey.results.size
    run.measured = lambda: sum(edge.accepted for edge in survey.edges)
    run.summary = lambda: _outcome(survey, run.done, finished and known is not None)
    try:
        frames = survey.ordered(_Frames(run), run.live)
        for frame in run.steps("mosaic", frames, run.source.count):
            with shielded():
                run.tell(survey.add(frame))
        if survey.all_before:
            survey.open_table()
        for remark in survey.remarks:
            notes.print(remark)
        with shielded():
            survey.settle()
        with progress("neighbours", None) as tell:
            looked = survey.finish()
            while True:
                with shielded():
                    said = next(looked, None)
                if said is None:
                    break
                tell(said)
        finished = True
    except (KeyboardInterrupt, OSError):
        stopped = True
        raise


def _resumes(asked: bool | None, run: Session, here: SurveyRun, given: list[Path]) -> bool:
    """Whether to continue the survey in the folder, which is locked, and moved aside if it is to be started anew.

    Args:
        asked: by --resume or --anew.
        run: the session.
        here: what is asked for.
        given: files that the survey reads.

    Raises:
        SignumError: if the folder holds another survey, or files of none, and neither was asked for.
    """
    run.lock()
    folder = run.folder
    before = find_survey(folder)
    trouble = page_trouble(folder)
    held = survey_files(folder) + ([PAGE] if trouble else [])
    if asked is False:
        if held:
            _move_aside(run, given)
        return False
    if before is None:
        if held and asked is None:
            raise SignumError(f"{folder}: holds {held[0]}, but no survey that can be continued; --anew moves it aside, "
                              "or choose another --out")
        return bool(asked)  # which the survey refuses
    if trouble:
        raise SignumError(trouble)
    own = {real_path(folder / name) for name in held}
    replaced = next((path for path in given if real_path(path) in own), None)
    if replaced is not None:
        raise SignumError(f"{replaced}: is of the survey in {folder}, which would replace it while reading it: choose "
                          "another --out, or copy it elsewhere")
    difference = before.differs(here)
    if difference:
        raise SignumError(f"{folder}: holds a survey made with {difference}; continue it with the same, or --anew "
                          "moves it aside")
    if before.source != here.source and asked is None:
        raise SignumError(f"{folder}: holds a survey of {before.source}, not of {here.source}; --resume continues it "
                          "with these frames, --anew moves it aside")
    if run.live and not has_journal(folder):
        raise SignumError(f"{folder}: the journal of its survey is lost, and {run.source.label} cannot show the frames "
                          "again; --anew moves it aside")
    record = read_record(folder)
    if record is not None and record[1]:
        notes.print(f"{folder}: the survey there is finished; frames that are new are added, picture and report made "
                    "anew")
    else:
        notes.print(f"{folder}: going on with the survey interrupted there; --anew starts it again")
    return True


def _move_aside(run: Session, given: list[Path]) -> None:
    """Move the folder aside and make it anew.

    Raises:
        SignumError: if it contains what the survey reads.
    """
    real = real_path(run.folder)
    if Path.cwd().is_relative_to(real):
        raise SignumError(f"{run.folder}: cannot be moved aside from inside it: call from elsewhere, or choose another "
                          "--out")
    inside = [path for path in (*given, Path(run.name)) if real_path(path).is_relative_to(real)]
    if inside:
        raise SignumError(f"{run.folder}: contains {inside[0]}, so it cannot be moved aside; choose another --out")
    notes.print(f"{run.folder}: what it holds is now in {move_aside(run.folder)}")
    real.mkdir()  # --out may be a link to it
    run.lock()


def _judge(survey: Survey, truth: Track) -> None:
    """Write `accuracy.csv`: errors of the largest component, by the ways its frames can be placed."""
    piece = survey.ranked()[0]
    with replacing(survey.ledger.shelf.make("accuracy.csv")) as half, closing(Table(half, ACCURACY)) as table:
        for way, place in WAYS.items():
            poses = place(survey.ledger, piece)
            if poses:
                table_rows = accuracy_rows(way, pose_errors(poses, truth), truth.unit)
                for line in table_rows:
                    table.write(line)
                if way == "all links":
                    for line in table_rows:
                        out.print(f"{line[1]}: RMS {line[3]} {line[2]}, median {line[5]}, most {line[8]}")


def _outcome(survey: Survey, done: int, judged: bool) -> str:
    """The outcome for the terminal: what was refused, and a line a file."""
    chained = [edge for edge in survey.edges if edge.kind in ("sequence", "live")]
    others = [edge for edge in survey.edges if edge.kind not in ("sequence", "live")]
    lines = [f"refused: {edge.frame_a} to {edge.frame_b} ({edge.reason})" for edge in chained if not edge.accepted]
    if len(survey.pieces) > 1:
        lines.append(f"the chain broke: {len(survey.pieces)} components; mosaic.png and poses.csv are of the largest")
    stored = {edge.frame_b for edge in chained if edge.accepted and edge.kind == "sequence"}
    chained = [edge for edge in chained if edge.kind == "sequence" or edge.frame_b not in stored]
    lines.append(f"{survey.out / 'mosaic.png'}: {done} frames, {sum(k.accepted for k in chained)} of {len(chained)} "
                 f"edges accepted" + (f", {sum(k.accepted for k in others)} of {len(others)} across" if others else ""))
    lines += survey.results.grounded
    if judged:
        lines.append(f"{survey.out / 'accuracy.csv'}: errors against the truth")
    return "\n".join(lines)
