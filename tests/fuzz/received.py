"""What comes from others: FMUs with invalid descriptions and answers, journals of hunts, tables with checksums."""

import io
import os
import random
import shutil
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from lxml import etree

from orchestrator.simulation.imported import worker
from orchestrator.simulation.imported.remote_instance import answer_of
from tests.fuzz.limits import ask
from tests.fuzz.logs import _json as odd_json
from tests.fuzz.logs import damaged

ODD = (
    "",
    "-1",
    "0",
    "1e309",
    "nan",
    "99999999999999999999",
    "x" * 5000,
    "\u202e",
    "a\u009bb",
    "..",
    "../x",
    "1.5",
    "true",
)
DESCRIPTIONS = (
    """<fmiModelDescription fmiVersion="2.0" modelName="Odd" guid="1">
  <CoSimulation modelIdentifier="odd" canHandleVariableCommunicationStepSize="true"/>
  <UnitDefinitions><Unit name="deg"><BaseUnit rad="1" factor="0.0174533"/></Unit></UnitDefinitions>
  <TypeDefinitions><SimpleType name="Mode"><Enumeration><Item name="OFF" value="0"/><Item name="ON" value="1"/>
  </Enumeration></SimpleType></TypeDefinitions>
  <DefaultExperiment startTime="0" stopTime="1"/>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="0" causality="input"><Real start="0" unit="deg"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="1" causality="output"><Real/></ScalarVariable>
    <ScalarVariable name="k" valueReference="2" causality="parameter" variability="fixed"><Integer start="3"/>
    </ScalarVariable>
    <ScalarVariable name="file" valueReference="4" causality="parameter" variability="fixed"><String start="a"/>
    </ScalarVariable>
    <ScalarVariable name="mode" valueReference="3" causality="output"><Enumeration declaredType="Mode"/>
    </ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="2" dependencies="1"/><Unknown index="5"/></Outputs></ModelStructure>
</fmiModelDescription>""",
    """<fmiModelDescription fmiVersion="3.0" modelName="Odd" instantiationToken="1">
  <CoSimulation modelIdentifier="odd"/>
  <UnitDefinitions><Unit name="u"><BaseUnit m="1" factor="2.0" offset="1"/></Unit></UnitDefinitions>
  <TypeDefinitions><EnumerationType name="Mode"><Item name="OFF" value="1"/><Item name="ON" value="2"/>
  </EnumerationType></TypeDefinitions>
  <ModelVariables>
    <Float64 name="u" valueReference="0" causality="input" start="0" unit="u"/>
    <UInt64 name="n" valueReference="5" causality="structuralParameter" start="2"/>
    <Float64 name="y" valueReference="1" causality="output"><Dimension start="3"/><Dimension valueReference="5"/>
    </Float64>
    <Int8 name="k" valueReference="3" causality="parameter" variability="fixed" start="1"/>
    <Enumeration name="mode" valueReference="2" causality="output" declaredType="Mode"/>
  </ModelVariables>
  <ModelStructure><Output valueReference="1" dependencies="0"/><Output valueReference="2"/></ModelStructure>
</fmiModelDescription>""",
)


def described(draw: random.Random) -> bytes:
    """Return a description with some things in it that should not be."""
    root = etree.fromstring(draw.choice(DESCRIPTIONS))
    for _ in range(draw.choice((1, 1, 2, 4))):
        items: list[Any] = list(root.iter())
        item = draw.choice(items)
        way = draw.randrange(6)
        if way <= 2 and len(item.attrib):
            item.set(draw.choice(sorted(item.attrib)), draw.choice(ODD))
        elif way == 3 and item.getparent() is not None:
            item.getparent().remove(item)
        elif way == 4 and item.getparent() is not None:
            copy = etree.fromstring(etree.tostring(item))
            for _ in range(draw.choice((1, 1, 300))):
                item.getparent().append(etree.fromstring(etree.tostring(copy)))
        elif len(item.attrib):
            del item.attrib[draw.choice(sorted(item.attrib))]
    data: bytes = etree.tostring(root)
    return data if draw.random() < 0.95 else damaged(data, draw)


def answers(draw: random.Random) -> str:
    """Write what is no answer into a pipe; return what was wrong with how it is read, empty if nothing."""
    reading, writing = os.pipe()
    try:
        body = odd_json(draw.choice(('[1, "text"]', '["what", 3, "text"]')), draw).encode(errors="replace")
        letter = draw.choice((b"=", b"!", b"M", b"?", b"\0"))
        data = worker.HEAD.pack(letter, draw.getrandbits(64), len(body)) + body
        data = damaged(data, draw) if draw.random() < 0.7 else data
        os.write(writing, data[:60_000])
        os.close(writing)
        writing = -1
        stream = worker.Stream(reading, worker.MAX_ANSWER)
        while True:
            letter, _, answer = stream.message()
            if letter in (b"!", b"M"):
                answer_of(letter, answer)
    except (EOFError, worker.ForeignAnswerError):
        return ""
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    finally:
        os.close(reading)
        if writing >= 0:
            os.close(writing)


def fuzz_fmus(folder: Path, log: Path, draw: random.Random) -> Iterator[tuple[list[str], str]]:
    """Look at one odd FMU after the other, and read odd answers."""
    path = folder / "odd.fmu"
    while True:
        for _ in range(20):
            yield ["an answer"], answers(draw)
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("modelDescription.xml", described(draw))
        words = draw.choice(
            (
                ["fmu", "check", str(path), "--no-load"],
                ["fmu", "check", str(path), "--as", "controller", "--json"],
                ["run", "guo2015-case4", "--controller", str(path), "--fmus", "none", "--out", str(folder / "out")],
            )
        )
        yield words, ask(words).mistake


STUDY = """
name: short
scenario: guo2015-case4
runs:
  latin_hypercube:
    n: 50
    vehicle.start.x: {uniform: [-0.1, 0.3]}
    vehicle.start.y: {uniform: [-0.1, 0.1]}
"""


def fuzz_journals(folder: Path, log: Path, draw: random.Random) -> Iterator[tuple[list[str], str]]:
    """Go on with hunts whose journal was damaged, or says something else."""
    study, out, whole = folder / "short.yaml", folder / "falsify", folder / "whole"
    study.write_text(STUDY)
    words = ["falsify", str(study), "--budget", "50", "--jobs", "1", "--out"]
    made = ask([*words, str(whole)], 600.0)
    assert (whole / "journal").is_dir(), made
    while True:
        shutil.rmtree(out, ignore_errors=True)
        shutil.copytree(whole, out)
        file = draw.choice(sorted((out / "journal").iterdir()))
        if file.suffix == ".npz" and draw.random() < 0.5:
            with np.load(file) as found:
                arrays = dict(found)
            name = draw.choice(sorted(arrays))
            arrays[name] = draw.choice(
                (
                    arrays[name][:0],
                    np.array(5),
                    np.full(arrays[name].shape, np.nan),
                    np.array(["x"]),
                    arrays[name][None],
                )
            )
            if draw.random() < 0.3:
                del arrays[name]
            np.savez(file, **arrays)
        else:
            file.write_bytes(damaged(file.read_bytes(), draw))
        again = [*words, str(out), "--resume"]
        yield again, ask(again, 120.0).mistake


def forged_table(table: bytes, draw: random.Random) -> bytes:
    """Return a table whose checksum is right and that says something else."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    from orchestrator.studies.sweep.store import ABOUT, CHECKSUM

    found = pq.read_table(pa.BufferReader(table))
    metadata = {key: value for key, value in (found.schema.metadata or {}).items() if key != CHECKSUM}
    if draw.random() < 0.7 and ABOUT in metadata:
        metadata[ABOUT] = odd_json(metadata[ABOUT].decode(), draw).encode(errors="replace")
    else:
        place = draw.randrange(found.num_columns)
        found = found.remove_column(place) if draw.random() < 0.5 else found.slice(0, draw.choice((0, 1)))
    file = io.BytesIO()
    pq.write_table(found.replace_schema_metadata(metadata), file)
    return file.getvalue()


def fuzz_parquet(folder: Path, log: Path, draw: random.Random) -> Iterator[tuple[list[str], str]]:
    """Run rows of damaged and forged tables again."""
    rows = log.with_name("table.parquet").read_bytes()
    path = folder / "odd.parquet"
    while True:
        path.write_bytes(damaged(rows, draw) if draw.random() < 0.3 else forged_table(rows, draw))
        words = ["replay", str(path), "--row", draw.choice("01"), "--no-page", "--out", str(folder / "out")]
        yield words, ask(words).mistake
