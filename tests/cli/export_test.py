# SPDX-License-Identifier: Apache-2.0
"""sateen export and view: what is written and served, read back."""

import base64
import http.client
import json
import pathlib
import re
import shutil
import signal
import socket
import struct
import subprocess
import unittest

from support import PROGRAM, CliTest, read_png, seam_ratio

PAGE = "<html><body><!--sateen-material--></body></html>"


def read_glb(data):
    """The JSON and the binary chunk."""
    magic, version, length = struct.unpack("<4sII", data[:12])
    assert (magic, version, length) == (b"glTF", 2, len(data))
    size, kind = struct.unpack("<I4s", data[12:20])
    assert kind == b"JSON" and size % 4 == 0
    text = json.loads(data[20 : 20 + size])
    binary_size, kind = struct.unpack("<I4s", data[20 + size : 28 + size])
    assert kind == b"BIN\0" and binary_size % 4 == 0
    binary = data[28 + size :]
    assert len(binary) == binary_size
    return text, binary


def validate(text, binary_length):
    """What glTF 2.0 asks of a file and the Khronos validator would say, for the parts used here."""
    said = []

    def check(condition, what):
        if not condition:
            said.append(what)

    check(text["buffers"] == [{"byteLength": binary_length}] or
          0 <= binary_length - text["buffers"][0]["byteLength"] < 4, "buffer and chunk differ")
    uses = {"bufferViews": "buffer", "accessors": "bufferView", "textures": "source", "nodes": "mesh"}
    targets = {"buffer": "buffers", "bufferView": "bufferViews", "source": "images", "mesh": "meshes"}
    for kind, key in uses.items():
        for entry in text[kind]:
            check(0 <= entry[key] < len(text[targets[key]]), f"{kind}: no {key} {entry[key]}")
    for view in text["bufferViews"]:
        check(view["byteOffset"] + view["byteLength"] <= text["buffers"][0]["byteLength"], "view past the buffer")
    for accessor in text["accessors"]:
        size = {5126: 4, 5123: 2}[accessor["componentType"]]
        check(text["bufferViews"][accessor["bufferView"]]["byteOffset"] % size == 0, "misaligned accessor")
    for image in text["images"]:
        check(image["mimeType"] in ("image/png", "image/jpeg"), "mime type")
        check("target" not in text["bufferViews"][image["bufferView"]], "an image in a vertex view")
    for mesh in text["meshes"]:
        for primitive in mesh["primitives"]:
            counts = {text["accessors"][a]["count"] for a in primitive["attributes"].values()}
            check(len(counts) == 1, "attributes of several lengths")
            check("POSITION" in primitive["attributes"] and "TANGENT" in primitive["attributes"], "attributes")
            check(text["accessors"][primitive["indices"]]["type"] == "SCALAR", "indices")
            check(primitive["material"] < len(text["materials"]), "material")
    check(all(set(s) <= {"nodes"} for s in text["scenes"]) and text["scene"] < len(text["scenes"]), "scene")
    return said


class Maps(CliTest):
    def setUp(self):
        super().setUp()
        self.material()

    def test_a_folder_of_maps_that_tile(self):
        said = self.succeed_with_json("export", "m.sateen", "-o", "maps", "--size", "64x48")
        names = sorted(pathlib.Path(path).name for path in said["written"])
        self.assertEqual(names, ["base_colour.png", "normal.png", "roughness.png"])
        cols, rows, image = read_png(self.folder / "maps/base_colour.png")
        self.assertEqual((cols, rows), (64, 48))
        for ratio in seam_ratio(image):
            self.assertLess(ratio, 1.6)
        _, _, normal = read_png(self.folder / "maps/normal.png")
        self.assertEqual(tuple(normal[0][:3]), (128, 128, 255))

    def test_the_base_colour_is_the_tileable_texture(self):
        self.succeed("export", "m.sateen", "-o", "maps", "--size", "32", "--seed", "5")
        self.succeed("synthesise", "m.sateen", "-o", "t.png", "--size", "32", "--seed", "5", "--tileable")
        self.assertEqual(read_png(self.folder / "maps/base_colour.png"), read_png(self.folder / "t.png"))

    def test_gltf_is_whole(self):
        self.succeed("export", "m.sateen", "-o", "m.glb", "--size", "32x16")
        text, binary = read_glb((self.folder / "m.glb").read_bytes())
        self.assertEqual(text["asset"]["version"], "2.0")
        material = text["materials"][0]
        for use in (material["pbrMetallicRoughness"]["baseColorTexture"],
                    material["pbrMetallicRoughness"]["metallicRoughnessTexture"],
                    material["normalTexture"]):
            image = text["images"][text["textures"][use["index"]]["source"]]
            view = text["bufferViews"][image["bufferView"]]
            start = view["byteOffset"]
            self.assertEqual(start % 4, 0)
            self.assertEqual(binary[start : start + 8], b"\x89PNG\r\n\x1a\n")
            self.file("image.png", binary[start : start + view["byteLength"]])
            read_png(self.folder / "image.png")
        for accessor in text["accessors"]:
            view = text["bufferViews"][accessor["bufferView"]]
            size = {5126: 4, 5123: 2}[accessor["componentType"]]
            width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[accessor["type"]]
            self.assertEqual(view["byteLength"], size * width * accessor["count"])
            self.assertLessEqual(view["byteOffset"] + view["byteLength"], len(binary))
        self.assertEqual(validate(text, len(binary)), [])
        position = text["accessors"][0]
        corners = struct.unpack_from("<12f", binary, text["bufferViews"][0]["byteOffset"])
        self.assertEqual(position["max"], [max(corners[i::3]) for i in range(3)])
        self.assertEqual(position["min"], [min(corners[i::3]) for i in range(3)])

    def test_refusals(self):
        self.refuse("export", "none.sateen", "-o", "m.glb", names="none.sateen")
        self.refuse("export", "m.sateen", "-o", "m.gltf", names=[".glb"])
        self.refuse("export", "m.sateen", "-o", "photo.png/maps", names="photo.png")
        self.refuse("export", "m.sateen", "-o", "m.glb", "--size", "9000", names="8192", code=2)
        self.refuse("export", "m.sateen", "-o", "", names="--output")
        self.refuse("export", "m.sateen", "-o", "none/m.glb", "--size", "16", names="none/m.glb")
        self.assertEqual(self.leftovers(), [])


class Page(CliTest):
    """With a program of its own that has a viewer beside it."""

    def setUp(self):
        super().setUp()
        self.material()
        (self.folder / "bin").mkdir()
        self.program = self.folder / "bin/sateen"
        shutil.copy(PROGRAM, self.program)

    def run_own(self, *arguments):
        return subprocess.run([self.program, *map(str, arguments)], cwd=self.folder,
                              capture_output=True, timeout=60)

    def test_without_the_viewer_one_line_says_how_to_build_it(self):
        for arguments in (["export", "m.sateen", "-o", "m.html"], ["view", "m.sateen", "--no-open"]):
            outcome = self.run_own(*arguments)
            self.assertEqual(outcome.returncode, 1)
            error = outcome.stderr.decode()
            self.assertEqual(error.count("\n"), 1)
            self.assertIn("tools/build_viewer.sh", error)
        self.assertFalse((self.folder / "m.html").exists())

    def test_the_page_holds_the_material(self):
        self.file("share/sateen/viewer.html", PAGE.encode())
        outcome = self.run_own("export", "m.sateen", "-o", "m.html")
        self.assertEqual(outcome.returncode, 0, outcome)
        page = (self.folder / "m.html").read_text()
        held = re.search('id="sateen-material" data-name="([^"]*)">([^<]*)</script>', page)
        self.assertEqual(base64.b64decode(held[2]), (self.folder / "m.sateen").read_bytes())
        self.assertEqual(held[1], "photo")

    def test_a_port_in_use_is_named(self):
        self.file("share/sateen/viewer.html", PAGE.encode())
        with socket.create_server(("127.0.0.1", 0)) as other:
            port = str(other.getsockname()[1])
            outcome = self.run_own("view", "m.sateen", "--no-open", "--port", port)
        self.assertEqual(outcome.returncode, 1)
        self.assertIn(f"--port: another program has {port}", outcome.stderr.decode())

    def test_view_serves_the_page_and_the_material_and_nothing_else(self):
        self.file("share/sateen/viewer.html", PAGE.encode())
        server = subprocess.Popen([self.program, "view", "m.sateen", "--no-open"], cwd=self.folder,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(server.stderr.close)
        self.addCleanup(server.stdout.close)
        self.addCleanup(server.kill)
        address = server.stdout.readline().strip()
        port = int(re.fullmatch(r"http://127\.0\.0\.1:(\d+)/\?url=material\.sateen", address)[1])

        def ask(path, method="GET", host=f"127.0.0.1:{port}"):
            connection = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
            connection.putrequest(method, path, skip_host=True)
            connection.putheader("Host", host)
            connection.endheaders()
            answer = connection.getresponse()
            body = answer.read()
            connection.close()
            return answer.status, body

        self.assertEqual(ask("/?url=material.sateen"), (200, PAGE.encode()))
        self.assertEqual(ask("/material.sateen"), (200, (self.folder / "m.sateen").read_bytes()))
        self.assertEqual(ask("/material.sateen", "HEAD"), (200, b""))
        for path in ("/m.sateen", "/../m.sateen", "//etc/passwd", "/share/sateen/viewer.html"):
            self.assertEqual(ask(path)[0], 404)
        self.assertEqual(ask("/", "POST")[0], 405)
        self.assertEqual(ask("/", host="elsewhere.example")[0], 421)
        server.send_signal(signal.SIGINT)
        self.assertEqual(server.wait(timeout=20), 0)


if __name__ == "__main__":
    unittest.main()
