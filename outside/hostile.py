"""Whether files that mean no good end soon, in little memory, and with a located error or as a model.

Gives a jbt binary some twenty files for each format that it reads: counts of what is not there, numbers that are none, cycles,
nests a million deep, loops without end, doublings, archives that unpack to much; and every example file of the project and
of the tests cut off at each twentieth. Each is a process of its own: `jbt check FILE`, and where that is content `jbt eval` at
one point, which compiles.

* The exit code is 0, or 1 with a place (line and column, or a byte), or 3 with the limit in words.
* A process takes a second of a processor (or --seconds) and 200 MB at most. One that takes longer runs twice more, and its
  least time counts: what else runs on a machine makes a process slower, and none faster.

    outside/hostile.py [JBT] [--only FORMAT] [--seconds S] [--all]

--all prints every file and what became of it, instead of a line for each format. Linux alone tells what a process took.
"""

import argparse
import base64
import concurrent.futures
import multiprocessing
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import zlib

ROOT = pathlib.Path(__file__).resolve().parent.parent
SECONDS, MEGABYTES, RUNS = 1.0, 200, 3
# Files that are cut off, and folders of them. Samples of other programs are no part of the project, and may not be there.
SAMPLES = os.environ.get("JBT_SAMPLES", "../shared/samples")
WHOLE = ["examples/foreign", "frontend/text/tests/readers/files", "fuzz/seeds", "examples/hero.jbt", "examples/goblet.jbt"]
WHOLE += [f"{SAMPLES}/{name}" for name in ("parsip/cake.blob", "parsip/complex.blob", "vm/hi.vm", "vm/bear.vm", "brlcad")]
CUTS = 20
MANY = 1_000_000
# A line and a column, a byte, the number of a point; or the file as a whole.
LOCATED = re.compile(
    r":\d+:\d+: (error|limit): |: byte \d+: |error: .*\bbyte \d+|error: (point|.*\bof particle) \d+"
    r"|error: (there are no points|the file (names no root|has no lines|has no solid)|\d+ bytes, which are neither text nor points)"
)


def npy():
    def array(dict_text, data=b"", version=1, length=None):
        head = dict_text.encode()
        size = len(head) if length is None else length
        return b"\x93NUMPY" + bytes([version, 0]) + struct.pack("<H" if version == 1 else "<I", size) + head + data

    shape = "{'descr': '<f4', 'fortran_order': False, 'shape': (%s), }"
    points = struct.pack("<9f", *range(9))
    yield "magic alone", b"\x93NUMPY"
    yield "header beyond the file", array(shape % "3, 3", points, 2, 0xFFFFFFF0)
    yield "version 9", array(shape % "3, 3", points, 9)
    for name, size in [("4e9 rows", "4294967295, 3"), ("1e30 rows", "1" + "0" * 30 + ", 3"), ("negative rows", "-1, 3"), ("no rows", "0, 3"),
                       ("no columns", "3, 0"), ("one number", "3,"), ("product is 2^64", "6148914691236517206, 3"), ("nest", "(" * MANY)]:
        yield name, array(shape % size, points, 2)
    for descr in ["O", "<f3", "<U99999999999", "|V4000000000", "<c16", "<f8"]:
        yield f"type {descr}", array((shape % "3, 3").replace("<f4", descr), points)
    for word in ["nan", "inf", "-inf", "3e38"]:
        yield word, array(shape % "3, 3", struct.pack("<9f", *[float(word)] * 9))
    yield "dict without end", array("{'descr': '<f4', " * 2000, points, 2)
    yield "one key, a million times", array("{" + "'shape': (3, 3), " * 100_000 + "}", points, 2)


def ply():
    head = "ply\nformat %s 1.0\nelement vertex %s\nproperty float x\nproperty float y\nproperty float z\n%send_header\n"
    data = b"0 0 0\n1 1 1\n"
    yield "head alone", b"ply\n"
    for count in ["4294967295", "18446744073709551616", "-1", "1e9", "nan", "0"]:
        yield f"{count} vertices", (head % ("ascii", count, "")).encode() + data
        yield f"{count} binary vertices", (head % ("binary_little_endian", count, "")).encode() + data
    yield "a list of 2^32", (head % ("binary_big_endian", 2, "property list uint float many\n")).encode() + b"\xff" * 64
    yield "a list of -1", (head % ("binary_big_endian", 2, "property list int float many\n")).encode() + b"\xff" * 64
    yield "elements before", b"ply\nformat ascii 1.0\n" + b"element e 999999999999\n" * 1000 + b"element vertex 1\nproperty float x\nend_header\n"
    empty = (head % ("binary_little_endian", 1, "")).replace("element vertex", "element e 18446744073709551615\nelement vertex")
    yield "empty elements", empty.encode() + bytes(12)
    yield "a million properties", (head % ("ascii", 1, "property float a\n" * MANY)).encode() + data
    yield "a million comments", b"ply\n" + b"comment x\n" * MANY
    yield "no line ends", b"ply " * MANY
    for word in ["nan", "inf", "1e999", "0x1p3", "1_0"]:
        yield word, (head % ("ascii", 1, "")).encode() + f"{word} 0 0\n".encode()


def vtk():
    head = "# vtk DataFile Version 3.0\nt\n%s\nDATASET POLYDATA\n%s\n"
    for kind in ["ASCII", "BINARY"]:
        for points in ["4294967295 float", "18446744073709551616 float", "-1 double", "6148914691236517206 double", "0 float", "x float", "1 complex"]:
            yield f"{kind} {points}", (head % (kind, "POINTS " + points)).encode() + b"0 0 0\n1 1 1\n"
    yield "nan", (head % ("ASCII", "POINTS 1 float")).encode() + b"nan 0 0\n"
    yield "inf, binary", (head % ("BINARY", "POINTS 1 float")).encode() + struct.pack(">3f", float("inf"), 0, 0)
    points = (head % ("ASCII", "POINTS 1 float")).encode() + b"0 0 0\n"
    yield "cells", points + b"CELLS 99999999999 99999999999999\n1 0\n"
    yield "fields", points + b"POINT_DATA 1\nFIELD f 999999999999\na 999999999 999999999999 float\n1\n"
    yield "a field of 2^64", points + b"POINT_DATA 4294967296\nSCALARS a float 4294967296\nLOOKUP_TABLE default\n1\n"
    yield "a million fields", points + b"POINT_DATA 1\n" + b"SCALARS a float 1\nLOOKUP_TABLE default\n1\n" * 100_000
    yield "other dataset", b"# vtk DataFile Version 3.0\nt\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 99999 99999 99999\n"
    yield "a title of a megabyte", b"# vtk DataFile Version 3.0\n" + b"t" * MANY + b"\nASCII\n"
    yield "points twice", points + b"POINTS 1 float\n0 0 0\n" * 1000


def vtu():
    head = '<VTKFile type="PolyData" byte_order="LittleEndian" header_type="UInt32" %s><PolyData><Piece NumberOfPoints="%s"><Points>'
    tail = "</Points></Piece></PolyData>%s</VTKFile>"

    def inline(count, array, extra="", rest=""):
        return (head % (extra, count) + array + tail % rest).encode()

    array = '<DataArray type="Float32" NumberOfComponents="3" format="%s" %s>%s</DataArray>'
    for count in ["4294967295", "18446744073709551616", "-1", "nan", "0"]:
        yield f"{count} points", inline(count, array % ("ascii", "", "0 0 0"))
    yield "nan", inline(1, array % ("ascii", "", "nan 0 0"))
    yield "base64 length of 2^32", inline(1, array % ("binary", "", base64.b64encode(b"\xff" * 4 + bytes(12)).decode()))
    yield "no base64", inline(1, array % ("binary", "", "!!!!" * 1000))
    raw = '<AppendedData encoding="raw">_abc</AppendedData>'
    yield "offset beyond", inline(1, array % ("appended", 'offset="99999999999999999999"', ""), rest=raw)
    yield "offset at the end", inline(1, array % ("appended", 'offset="18446744073709551615"', ""), rest=raw)
    zipped = 'compressor="vtkZLibDataCompressor"'

    def blocks(count, size, last, packed):
        data = struct.pack("<3I", count, size, last) + b"".join(struct.pack("<I", len(one)) for one in packed) + b"".join(packed)
        return '<AppendedData encoding="base64">_' + base64.b64encode(data).decode() + "</AppendedData>"

    appended = array % ("appended", 'offset="0"', "")
    bomb = zlib.compress(bytes(1 << 28), 9)
    yield "256 MB of zeros", inline(22_369_621, appended, zipped, blocks(1, 1 << 28, 0, [bomb]))
    yield "a bomb that says little", inline(4, appended, zipped, blocks(1, 48, 0, [bomb]))
    yield "bombs", inline(4, appended, zipped, blocks(64, 1 << 28, 0, [bomb] * 64))
    yield "2^32 blocks", inline(4, appended, zipped, blocks(0xFFFFFFFF, 1, 0, []))
    yield "blocks of 2^32", inline(4, appended, zipped, blocks(2, 0xFFFFFFFF, 0, [b"x", b"y"]))
    yield "no zlib", inline(4, appended, zipped, blocks(1, 48, 0, [b"no zlib at all"]))
    yield "a nest", b"<VTKFile>" + b"<a>" * MANY
    yield "attributes", b"<VTKFile " + b'a="b" ' * MANY + b">"
    yield "entities", b'<!DOCTYPE a [<!ENTITY b "&c;&c;">]>' + inline("&b;", array % ("ascii", "", "&b;"))
    yield "a tag without end", b"<VTKFile type=" + b'"' * MANY
    yield "a comment without end", b"<VTKFile><!--" + b"-" * MANY
    yield "a million pieces", (head % ("", 0)).encode() + b'</Points></Piece><Piece NumberOfPoints="4000000000"><Points>' * 100_000


def cif():
    tags = "loop_\n_atom_site.group_PDB\n_atom_site.type_symbol\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n"
    row = "ATOM C 0 0 0\n"
    yield "a loop without rows", f"data_x\n{tags}".encode()
    yield "half a row", f"data_x\n{tags}ATOM C 0".encode()
    yield "a loop without tags", b"data_x\nloop_\n1 2 3\n"
    yield "loops", b"data_x\n" + b"loop_ " * MANY
    yield "a million tags", b"data_x\nloop_\n" + b"".join(b"_atom_site.a%d\n" % at for at in range(200_000)) + b"1 2 3\n"
    yield "one tag, a million times", f"data_x\n{tags}".encode() + b"_atom_site.Cartn_x\n" * 200_000 + b"1 " * 1000
    for word in ["nan", "inf", "1e999", "?", ".", "'0", ";"]:
        yield f"x is {word}", f"data_x\n{tags}ATOM C {word} 0 0\n".encode()
    yield "a text without end", f"data_x\n{tags}\n;".encode() + b"x\n" * MANY
    yield "a quote without end", b"data_x\n_a '" + b"x" * MANY
    yield "an element of a megabyte", f"data_x\n{tags}ATOM ".encode() + b"C" * MANY + b" 0 0 0\n"
    yield "one place", f"data_x\n{tags}".encode() + row.encode() * 100_000
    yield "comments", b"data_x\n" + b"#\n" * MANY
    yield "blocks", b"data_x\n" * 300_000
    yield "a value for nothing", b"data_x\n" + b"1 " * MANY
    yield "binary", b"data_x\n" + bytes(range(256)) * 1000


def pdb():
    line = "ATOM      1  CA  ALA A   1    %s%s%s  1.00  0.00           C  \n"
    for word in ["     nan", "     inf", "   1e999", "--------", "        ", "99999999", "1234.5.6"]:
        yield f"x is {word.strip()}", (line % (word, "   0.000", "   0.000")).encode()
    good = line % ("   0.000", "   0.000", "   0.000")
    yield "one name, 100,000 times", good.encode() * 100_000
    yield "short lines", b"ATOM\n" * MANY
    yield "no line ends", b"ATOM  " * MANY
    yield "models without atoms", b"MODEL        1\nENDMDL\n" * 200_000
    yield "ends of models", b"HEADER\n" + b"ENDMDL\n" * MANY
    yield "serial numbers", good.replace("    1  CA", "*****  CA").encode()
    yield "bytes beyond ASCII", good.replace("ALA", "\xc4\xd6\xdc").encode("latin-1")
    yield "bytes between", good.encode().replace(b"   0.000", b"\xe2\x82\xac0.00", 1)
    yield "carriage returns", b"HEADER" + b"\r" * MANY
    yield "no atoms", b"HEADER    x\n" + b"REMARK\n" * 100_000
    yield "far apart", (line % ("99999999", "-9999999", "   0.000")).encode() + good.encode()
    yield "occupancy", good.replace("  1.00  0.00", "   nan   inf").encode()
    yield "a line of a megabyte", b"ATOM  " + b"9" * MANY + b"\n"


def xyz():
    for count in ["4294967295", "18446744073709551616", "-1", "0", "1e3", "99999999999999999999999"]:
        yield f"{count} atoms", f"{count}\n\nC 0 0 0\n".encode()
    for word in ["nan", "inf", "1e999", "1D+999", "0x10", "-"]:
        yield f"x is {word}", f"1\n\nC {word} 0 0\n".encode()
        yield f"a cloud with {word}", f"0 0 0\n{word} 0 0\n".encode()
    yield "properties of 2^64", b'1\nProperties=species:S:18446744073709551615:pos:R:3\nC 0 0 0\n'
    yield "a million properties", b"1\nProperties=" + b"a:R:1:" * 200_000 + b"pos:R:3\nC 0 0 0\n"
    yield "frames", b"1\n\nC 0 0 0\n" * 100_000
    yield "floats that are none", b"\xff" * 12_000
    yield "floats and a half", struct.pack("<3f", 0, 0, 0) * 1000 + b"x"
    yield "an element of a megabyte", b"1\n\n" + b"C" * MANY + b" 0 0 0\n"
    yield "a line of numbers", b"0 " * MANY


def csv():
    yield "a head alone", b"x,y,z,radius\n"
    for word in ["nan", "inf", "1e999", "-1", "", "'", '"']:
        yield f"x is {word}", f"x,y,z,radius\n0,0,0,1\n{word},0,0,1\n".encode()
        yield f"a radius of {word}", f"x,y,z,radius\n0,0,0,1\n1,0,0,{word}\n".encode()
    yield "a quote without end", b'x,y,z\n"' + b"0,0,0\n" * 200_000
    yield "a million columns", b"x,y,z" + b",a" * MANY + b"\n" + b"0," * 1000
    yield "one column, many times", b"x,x,x,x,y,z\n0,0,0,0,0,0\n"
    yield "rows of other lengths", b"x,y,z\n" + b"0,0,0\n0,0\n" * 1000
    yield "no rows", b"\n" * MANY
    yield "separators", b",;\t" * MANY
    yield "a cell of a megabyte", b"x,y,z\n0,0," + b"9" * MANY + b"\n"
    yield "bytes", bytes(range(256)) * 4000
    yield "colours", b"x,y,z,radius,r,g,b\n0,0,0,1,1e300,nan,-5\n"


def threejs():
    leaf = '{"type":"ScalisPoint","volType":"dist","density":%s,"materials":[{}],"v":[{"position":{"x":0,"y":0,"z":0},"thickness":%s}]}'
    root = '{"type":"RootNode","ricci_n":%s,"iso":%s,"children":[%s]}'
    good = leaf % (1, 1)
    for name, open_, close in [("brackets", "[", "]"), ("objects", '{"a":', "}"), ("nodes", '{"type":"MinNode","children":[', "]}")]:
        yield f"{name} without end", open_.encode() * MANY
        yield f"{name} in {name}", (root % (64, 1, open_ * 20_000 + good + close * 20_000)).encode()
    for number in ["1e999", "-1e999", "NaN", "0", "-1", "1e-300", "1e15"]:
        yield f"thickness {number}", (root % (64, 1, leaf % (1, number))).encode()
        yield f"exponent and iso {number}", (root % (number, number, good)).encode()
    yield "a string without end", b'{"type":"' + b"x" * MANY
    yield "escapes", b'{"type":"' + b"\\ud800" * 100_000 + b'"}'
    yield "one key, many times", b'{"type":"RootNode",' + b'"children":[],' * 100_000 + b'"iso":1}'
    yield "a hundred thousand points", (root % (64, 1, ",".join([good] * 20_000))).encode()
    yield "a number of a megabyte", (root % (64, 1, leaf % (1, "9" * MANY))).encode()
    yield "null", b"null"
    twist = '{"type":"TwistNode","twist_amout":1,"axis_x":0,"axis_y":1,"axis_z":0,"children":['
    yield "twists", (root % (64, 1, twist * 300 + good + "]}" * 300)).encode()


def pov():
    ball = "sphere { 0, 1, 1 }"
    yield "a loop without end", b"#while (1) #end"
    yield "a loop that does nothing", b"#for (I, 0, 1e15) #end"
    yield "loops in loops", ("#for (I, 0, 99) " * 12 + ball + " #end" * 12).encode()
    yield "a step of 0", ("blob { #for (I, 0, 1, 0) " + ball + " #end }").encode()
    yield "a step of nan", ("blob { #for (I, 0, 1, 0/0) " + ball + " #end }").encode()
    doubled = "".join(f"#declare B{at + 1} = union {{ object {{ B{at} }} object {{ B{at} }} }}\n" for at in range(60))
    yield "doublings", f"#declare B0 = blob {{ {ball} }}\n{doubled}object {{ B60 }}".encode()
    numbers = "".join(f"#declare N = N + N;\n" for _ in range(5000))
    yield "numbers that double", f"#declare N = 1;\n{numbers}blob {{ sphere {{ N, 1, 1 }} }}".encode()
    yield "a name of itself", b"#declare A = object { A }\nobject { A }"
    yield "braces", b"blob { " * 300_000
    yield "parentheses", b"blob { sphere { " + b"(" * MANY
    yield "vectors", b"blob { sphere { " + b"<" * MANY
    yield "signs", b"blob { sphere { " + b"-" * MANY + b"1, 1, 1 } }"
    yield "questions", b"blob { sphere { " + b"(1 ? " * 100_000 + b"0"
    yield "comments", b"/*" * MANY
    yield "conditions", b"#if (1) " * 300_000
    yield "includes of itself", b'#include "f.pov"\n' * 100
    yield "includes of what is no scene", b"/*" + b"x" * MANY + b"*/ 0 " + b'#include "f.pov"\n' * 20_000
    yield "a file elsewhere", b'#include "/etc/passwd"\nblob { sphere { 0, 1, 1 } }'
    for scale in ["0", "1e300", "1e-300", "<1,0,1>", "0/0"]:
        yield f"scale {scale}", f"blob {{ {ball} scale {scale} }}".encode()
    yield "100,000 transforms", ("blob { " + ball + " rotate 1*x " * 100_000 + "}").encode()
    yield "30,000 balls", ("blob { " + ball * 30_000 + "}").encode()
    yield "powers", b"blob { sphere { 0, pow(10, 400), exp(1e9) } }"
    yield "macros", b"#macro M(A) M(A) #end\nM(1)\nblob { M(1) }"


def rib():
    unit = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"
    good = f"Blobby 1 [1001 0] [{unit}] [\"\"]\n"
    for code in ["1001 4294967295", "1001 -1", "1002 0", "0 999999999 0", "2 -1", "0 1 0", "4 5 6", "1001 1e30", "99 1", "1003 0 0", "9000 1 2"]:
        yield f"code {code}", f'Blobby 1 [{code}] [{unit}] [""]'.encode()
    doubled = " ".join(f"0 2 {at} {at}" for at in range(2000))
    yield "sums of sums", f'Blobby 1 [1001 0 {doubled}] [{unit}] [""]'.encode()
    products = " ".join(f"1 2 {at} {at}" for at in range(2000))
    yield "products of products", f'Blobby 1 [1001 0 {products}] [{unit}] [""]'.encode()
    yield "a sum of 100,000", ('Blobby 1 [1001 0 0 100000 ' + "0 " * 100_000 + f'] [{unit}] [""]').encode()
    yield "4,000,000,000 leaves", f'Blobby 4000000000 [1001 0] [{unit}] [""]'.encode()
    for word in ["AttributeBegin", "TransformBegin", "WorldBegin", "ObjectBegin 1", "MotionBegin [0 1]", "FrameBegin 1"]:
        yield f"a million {word}", f"{word}\n".encode() * 300_000
    objects = "".join(f"ObjectBegin {at + 1} ObjectInstance {at} ObjectInstance {at} ObjectEnd\n" for at in range(40))
    yield "objects that double", f"ObjectBegin 0 {good} ObjectEnd\n{objects}ObjectInstance 40".encode()
    yield "an object of itself", b"ObjectBegin 1 ObjectInstance 1 ObjectEnd ObjectInstance 1"
    yield "an array without end", b"Blobby 1 [" + b"1 " * MANY
    yield "arrays in arrays", b"Blobby 1 " + b"[" * MANY
    yield "a string without end", b'Display "' + b"x" * MANY
    for scale in ["0 0 0", "1e300 1 1", "1e-300 1 1", "nan 1 1"]:
        yield f"Scale {scale}", f"Scale {scale}\n{good}".encode()
    yield "100,000 rotations", b"Rotate 1 1 1 1\n" * 100_000 + good.encode()
    yield "20,000 blobbies", good.encode() * 20_000


def parsip():
    node = "[BLOBNODE %d]\nIsOperator=1\nOperatorType=%s\nChildrenCount=%d\nChildrenIDs=(%s)\n"
    leaf = "[BLOBNODE %d]\nIsOperator=0\nPrimitiveType=POINT\nposition=(0, 0, 0)\n"
    tail = "[Global]\nRootIDs=(0)\n"
    yield "a cycle", (node % (0, "UNION", 1, "0") + tail).encode()
    yield "a cycle of two", (node % (0, "UNION", 1, "1") + node % (1, "UNION", 1, "0") + tail).encode()
    chain = "".join(node % (at, "UNION", 1, at + 1) for at in range(20_000))
    yield "a chain", (chain + leaf % 20_000 + tail).encode()
    doubled = "".join(node % (at, "BLEND", 2, f"{at + 1}, {at + 1}") for at in range(60))
    yield "doublings", (doubled + leaf % 60 + tail).encode()
    yield "4e9 children", (node % (0, "BLEND", 4_000_000_000, "1") + leaf % 1 + tail).encode()
    yield "a range of 4e9", (node % (0, "BLEND", 2, "1") + "ChildrenIDsUseRange=1\nChildrenIDsRange=(1, 4000000000)\n" + tail).encode()
    yield "a range backwards", (node % (0, "BLEND", 2, "1") + "ChildrenIDsUseRange=1\nChildrenIDsRange=(9, 1)\n" + tail).encode()
    yield "a node that is missing", (node % (0, "BLEND", 1, "7") + tail).encode()
    yield "a node twice", (leaf % 0 * 2 + tail).encode()
    yield "node 2^64", b"[BLOBNODE 18446744073709551616]\n"
    yield "node -1", b"[BLOBNODE -1]\nIsOperator=0\n"
    yield "an operator of nothing", (node % (0, "FOO", 0, "") + tail).encode()
    for word in ["nan", "inf", "1e999", ""]:
        yield f"a place of {word}", (leaf % 0).replace("(0,", f"({word},").encode() + tail.encode()
        yield f"a scale of {word}", (leaf % 0 + f"AffineScale=({word}, 0, 1)\n").encode() + tail.encode()
    yield "sections", b"[BLOBNODE 0]\n" * 200_000
    yield "brackets", b"[" * MANY
    yield "keys", b"[BLOBNODE 0]\n" + b"a=1\n" * 300_000
    yield "a list without end", b"[BLOBNODE 0]\nChildrenIDs=(" + b"1, " * 300_000


def record(name, major, minor, body, attributes=b""):
    """An object of a BRL-CAD file, with lengths of four bytes."""
    parts = [name.encode() + b"\0"] + ([attributes] if attributes else []) + [body]
    inner = b"".join(struct.pack(">I", len(part)) + part for part in parts)
    head = bytes([0x76, 0xB0, 0xA0 if attributes else 0x80, 0xA0, major, minor])
    length = (len(head) + 4 + len(inner) + 1 + 7) // 8 * 8
    return (head + struct.pack(">I", length // 8) + inner).ljust(length - 1, b"\0") + b"\x35"


def combination(name, members, steps=None, leaves=None):
    names = b"".join(member.encode() + b"\0" + b"\xff" * 4 for member in members)
    steps = [] if steps is None else steps
    counts = struct.pack(">5I", 0, len(members) if leaves is None else leaves, len(names), len(steps), 1)
    return record(name, 1, 31, b"\x02" + counts + names + bytes(steps))


def brlcad():
    head = bytes([0x76, 1, 0, 0, 0, 0, 1, 0x35])
    ball = record("s", 1, 3, struct.pack(">12d", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1))
    yield "a head alone", head
    yield "a length of 2^32", head + bytes([0x76, 0xB0, 0x80, 0xA0, 1, 3]) + b"\xff" * 40
    yield "a length of 2^64", head + bytes([0x76, 0xF8, 0xC0, 0xE0, 1, 3]) + b"\xff" * 80
    yield "a length of 0", head + bytes([0x76, 0xB0, 0x80, 0xA0, 1, 3]) + bytes(40)
    yield "free records", head + bytes([0x76, 2, 0, 0, 0, 0, 1, 0x35]) * 500_000
    yield "a cycle", head + combination("a", ["b"]) + combination("b", ["a"])
    yield "itself", head + ball + combination("a", ["s", "a"])
    doubled = b"".join(combination(f"c{at + 1}", [f"c{at}"] * 2) for at in range(60))
    yield "doublings", head + ball + combination("c0", ["s", "s"]) + doubled
    yield "a chain", head + ball + combination("c0", ["s"]) + b"".join(combination(f"c{at + 1}", [f"c{at}"]) for at in range(20_000))
    yield "4e9 leaves", head + ball + combination("a", ["s"], leaves=0xFFFFFFFF)
    yield "steps of nothing", head + ball + combination("a", ["s"], [2, 3, 4, 5, 6] * 1000)
    yield "complements", head + ball + combination("a", ["s"], [1] + [6] * 100_000)
    yield "unions to the right", head + ball + combination("a", ["s"] * 3000, [1] * 3000 + [2] * 2999)
    yield "differences to the right", head + ball + combination("a", ["s"] * 3000, [1] * 3000 + [4] * 2999)
    yield "exclusive ors", head + ball + combination("a", ["s"] * 2000, [1] + [1, 5] * 1999)
    for number in [float("nan"), float("inf"), 1e300, 0.0]:
        yield f"a ball of {number}", head + record("s", 1, 3, struct.pack(">12d", *[number] * 12))
    yield "a body too short", head + record("s", 1, 3, b"\0" * 5)
    yield "planes", head + record("p", 1, 14, struct.pack(">I", 0xFFFFFFFF) + bytes(64))
    yield "a pipe", head + record("p", 1, 15, struct.pack(">I", 0xFFFFFFFF) + bytes(64))
    places = b"".join(struct.pack(">6d", at % 7, at % 5, at, 0, 1, .1) for at in range(5000))
    yield "5,000 pipe points", head + record("p", 1, 15, struct.pack(">I", 5000) + places)
    yield "one name, 20,000 times", head + ball * 20_000
    yield "20,000 balls", head + ball + combination("a", ["s"] * 20_000)


def brlcad_text():
    ball = "put s sph V {0 0 0} A {1 0 0} B {0 1 0} C {0 0 1}\n"
    title = "title {t}\nunits mm\n"
    yield "braces", title.encode() + b"put " + b"{" * MANY
    yield "braces and ends", (title + "put a comb region no tree " + "{u " * 20_000 + "{l s}" + " {l s}}" * 20_000).encode()
    yield "trees without end", (title + "put a comb region no tree " + "{u {l s} " * 200_000).encode()
    yield "a cycle", (title + "put a comb region no tree {l b}\nput b comb region no tree {l a}\n").encode()
    doubled = "".join(f"put c{at + 1} comb region no tree {{u {{l c{at}}} {{l c{at}}}}}\n" for at in range(60))
    yield "doublings", (title + ball + "put c0 comb region no tree {u {l s} {l s}}\n" + doubled).encode()
    yield "complements", (title + ball + "put a comb region no tree " + "{! " * 20_000 + "{l s}" + "}" * 20_000).encode()
    for word in ["nan", "inf", "1e999", "1e300", "x", ""]:
        yield f"a number of {word}", (title + ball.replace("V {0", "V {" + word)).encode()
    yield "a matrix of 15", (title + ball + "put a comb region no tree {l s {1 0 0 0 0 1 0 0 0 0 1 0 0 0 0}}\n").encode()
    yield "a matrix of zeros", (title + ball + "put a comb region no tree {l s {0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0}}\n").encode()
    yield "keys", (title + "put s sph " + "V {0 0 0} " * 100_000 + "\n").encode()
    yield "attributes", (title + ball + "attr set {s} {color} {1/2/3}\n" * 50_000).encode()
    yield "no kind", (title + "put s\n").encode()
    yield "put alone", (title + "put\n" * 200_000).encode()
    yield "version 4, no members", b"I 0 v4\nt\nC Y a 1 0 4000000000 0 0 0 0 0 0 0 0 0\n"
    yield "version 4, numbers", b"I 0 v4\nt\nS 19 e 1 " + b"nan " * 24 + b"\n"
    yield "version 4, a cycle", b"I 0 v4\nt\nC Y a 1 0 1 0 0 0 0 0 0 0 0 0\nM u a " + b"1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 0\n"
    yield "version 4, short", b"I 0 v4\nt\n" + b"S\n" * 300_000


def vm():
    yield "itself", b"_0 add _0 _0\n"
    yield "forward", b"_0 add _1 _1\n_1 var-x\n"
    yield "doublings", b"_0 var-x\n" + b"".join(b"_%x add _%x _%x\n" % (at + 1, at, at) for at in range(5000))
    yield "squares", b"_0 var-x\n" + b"".join(b"_%x square _%x\n" % (at + 1, at) for at in range(5000))
    yield "100,001 steps", b"_0 var-x\n" + b"".join(b"_%x neg _%x\n" % (at + 1, at) for at in range(100_001))
    for word in ["nan", "inf", "1e999", "-", ""]:
        yield f"a constant {word}", f"_0 const {word}\n".encode()
    yield "one name twice", b"_0 var-x\n_0 var-y\n"
    yield "no such operation", b"_0 frobnicate\n"
    yield "a name of a megabyte", b"_" + b"0" * MANY + b" var-x\n"
    yield "words", b"_0 add " + b"_0 " * MANY
    yield "comments", b"#\n" * MANY
    yield "logarithms", b"_0 const -1\n_1 ln _0\n_2 sqrt _0\n_3 div _1 _2\n"
    yield "bytes", bytes(range(256)) * 1000
    yield "operands missing", b"_0 var-x\n_1 add _0\n"


def jbt():
    def text(body):
        return ("jbt 1\n" + body).encode()

    ball = "point { radius 1 }"
    lets = "".join(f"let a{at + 1} = sum {{ use a{at} use a{at} }}\n" for at in range(60))
    yield "doublings", text(f"let a0 = {ball}\n{lets}use a60")
    yield "braces", text("sum { " * 300_000)
    yield "parentheses", text("point { radius " + "(" * MANY)
    yield "loops", text("sum { " + "for i in 0 .. 1000 { " * 8 + ball + " }" * 9)
    yield "a loop of 1e15", text("sum { for i in 0 .. 1e15 { " + ball + " } }")
    yield "repeats", text("repeat axis x spacing 1 count 1048576 { " * 8 + ball + " }" * 8)
    yield "signs", text("point { radius " + "-" * MANY + "1 }")
    yield "an expression", text("expression { " + "sin(" * 100_000 + "x" + ")" * 100_000 + " }")
    yield "a sum", text("expression { x" + " + x" * 99_000 + " }")
    yield "a definition of itself", text("def f() { f() }\nf()")
    yield "an include of itself", text('include "f.jbt"\n' + ball)
    yield "a file elsewhere", text('particles { file "/etc/passwd" radius 1 }')
    yield "parameters", text("".join(f"param p{at} = {at}\n" for at in range(20_000)) + ball)
    yield "a name of a megabyte", text("let " + "a" * MANY + " = " + ball)
    yield "a list", text("polyline { points (" + "(0 0 0) " * 70_000 + ") radius 1 }")
    yield "twists", text("twist axis z rate 1 { " * 5000 + ball + " }" * 5000)
    yield "shells", text("shell 0.1 { " * 5000 + ball + " }" * 5000)
    yield "a string without end", text('let a = "' + "x" * MANY)
    yield "a style of constants", text("style a = {" + "".join(f" constant c{at} 1" for at in range(100_000)) + " }\n" + ball)
    yield "wide attributes", text("".join(f"attribute a{at} 64\n" for at in range(100)) + ball)
    yield "a number of a megabyte", text("point { radius " + "9" * MANY + " }")


FORMATS = {"npy": npy, "ply": ply, "vtk": vtk, "vtu": vtu, "cif": cif, "pdb": pdb, "xyz": xyz, "csv": csv, "json": threejs, "pov": pov, "rib": rib,
           "blob": parsip, "g": brlcad, "asc": brlcad_text, "vm": vm, "jbt": jbt}
# Points without radii of their own need one.
SIZED = {"npy", "vtk", "vtu"}
UNSIZED = {"ply", "xyz", "csv"}


def cut(form, folder):
    """Whole files of a format, cut off at each twentieth."""
    for place in [ROOT / name for name in WHOLE]:
        for path in [place] if place.suffix == f".{form}" and place.exists() else sorted(place.rglob(f"*.{form}")):
            whole = path.read_bytes()
            for part in range(CUTS):
                yield f"{part} twentieths of {path.name}", whole[: len(whole) * part // CUTS]


def took(command, folder):
    """Runs a command: its exit code, what it says, seconds of a processor, and MB. To be called in a small process: what
    the caller takes counts for its children, too."""
    streams = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL}
    with tempfile.TemporaryFile() as said, subprocess.Popen(command, cwd=folder, stderr=said, **streams) as child:
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        message = said.read().decode(errors="replace")
    return child.returncode, message, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1e3


def faults(code, message):
    if code not in (0, 1, 3):
        return f"exit code {code}"
    if code == 1 and not LOCATED.search(message):
        return "no place"
    if code == 3 and "limit: " not in message:
        return "no limit in words"
    if len(message) > 100_000:
        return f"{len(message)} characters are said"
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("jbt", nargs="?", type=pathlib.Path, default=ROOT / "target/release/jbt")
    parser.add_argument("--only", metavar="FORMAT", choices=FORMATS, help=", ".join(FORMATS))
    parser.add_argument("--seconds", type=float, default=SECONDS, help="of a processor, the most that a file may take")
    parser.add_argument("--all", action="store_true", help="print every file")
    arguments = parser.parse_args()
    jbt, wrong = arguments.jbt.resolve(), 0
    print(f"{'format':8} {'files':>6} {'models':>6} {'errors':>6} {'limits':>6} {'most s':>7} {'most MB':>7}")
    small = concurrent.futures.ProcessPoolExecutor(1, multiprocessing.get_context("spawn"))
    with tempfile.TemporaryDirectory() as folder, small as launcher:
        (pathlib.Path(folder) / "points.csv").write_text("x,y,z\n0,0,0\n")
        for form in [arguments.only] if arguments.only else FORMATS:
            codes, most = [], [0.0, 0.0]
            for name, content in [*FORMATS[form](), *cut(form, folder)]:
                (pathlib.Path(folder) / f"f.{form}").write_bytes(content)
                options = ["--radius", "1"] if form in SIZED or form in UNSIZED and b"radius" not in content else []
                asked = [["check"], ["eval", "--points", "points.csv", "-o", "-"]]
                for command in asked:
                    process = [jbt, *command, *options, f"f.{form}"]
                    code, message, seconds, memory = launcher.submit(took, process, folder).result()
                    for _ in range(1, RUNS):
                        if seconds > arguments.seconds:
                            seconds = min(seconds, launcher.submit(took, process, folder).result()[2])
                    fault = faults(code, message)
                    if seconds > arguments.seconds or memory > MEGABYTES:
                        fault = fault or f"{seconds:.2f} s, {memory:.0f} MB"
                    if fault:
                        wrong += 1
                        print(f"FAILED  {form}, {name}, {command[0]}: {fault}\n        {message[:300].strip()}")
                    elif arguments.all:
                        said = message.strip().splitlines() or [""]
                        print(f"  {form}, {name}, {command[0]}: {code}, {seconds:.2f} s, {memory:.0f} MB: {said[0][:120]}")
                    most = [max(most[0], seconds), max(most[1], memory)]
                    if command[0] == "check":
                        codes.append(code)
                    if code != 0:
                        break
            print(f"{form:8} {len(codes):6} {codes.count(0):6} {codes.count(1):6} {codes.count(3):6} {most[0]:7.2f} {most[1]:7.0f}")
    print(f"{wrong} failed")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
