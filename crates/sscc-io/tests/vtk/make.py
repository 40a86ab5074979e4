"""Writes the files of this folder with meshio 5.3.5 and VTK 9.7.2: `python make.py`.

The files have two tetrahedra that do not touch. The displacements `U` move the second one into the first.
"""

import os

import meshio
import numpy as np
import vtk

os.chdir(os.path.dirname(os.path.abspath(__file__)))
points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [2, 0, 0], [3, 0, 0], [2, 1, 0], [2, 0, 1]], float)
u = np.zeros((8, 3))
u[4:] = [-1.75, 0.125, 0.125]
mesh = meshio.Mesh(
    points,
    [("tetra", np.array([[0, 1, 2, 3], [4, 5, 6, 7]]))],
    point_data={"T": np.arange(8.0), "velocity": np.ones((8, 3), np.float32), "U": u},
    cell_data={"part": [np.array([1, 2])]},
)
meshio.vtu.write("meshio_zlib.vtu", mesh)
meshio.vtu.write("meshio_binary.vtu", mesh, compression=None)
meshio.vtu.write("meshio_ascii.vtu", mesh, binary=False)
meshio.vtk.write("meshio_51.vtk", mesh)
meshio.write("meshio_42.vtk", mesh, file_format="vtk42", binary=False)

reader = vtk.vtkXMLUnstructuredGridReader()
reader.SetFileName("meshio_binary.vtu")
reader.Update()
grid = reader.GetOutput()
for name, mode, compressor, header, order, encode in [
    ("ascii", "Ascii", "None", 32, "Little", 0),
    ("binary", "Binary", "None", 64, "Big", 0),
    ("binary_zlib", "Binary", "ZLib", 32, "Little", 0),
    ("binary_lz4", "Binary", "LZ4", 32, "Little", 0),
    ("raw", "Appended", "None", 64, "Little", 0),
    ("raw_zlib", "Appended", "ZLib", 64, "Little", 0),
    ("raw_zlib_big", "Appended", "ZLib", 32, "Big", 0),
    ("base64", "Appended", "None", 32, "Little", 1),
    ("base64_zlib", "Appended", "ZLib", 64, "Little", 1),
]:
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetInputData(grid)
    writer.SetFileName(f"vtk_{name}.vtu")
    getattr(writer, f"SetDataModeTo{mode}")()
    getattr(writer, f"SetCompressorTypeTo{compressor}")()
    getattr(writer, f"SetHeaderTypeToUInt{header}")()
    getattr(writer, f"SetByteOrderTo{order}Endian")()
    writer.SetEncodeAppendedData(encode)
    writer.SetBlockSize(64)  # several blocks
    writer.Write()
for version in (42, 51):
    for kind in ("ASCII", "Binary"):
        writer = vtk.vtkUnstructuredGridWriter()
        writer.SetInputData(grid)
        writer.SetFileVersion(version)
        writer.SetFileName(f"vtk_{version}_{kind.lower()}.vtk")
        getattr(writer, f"SetFileTypeTo{kind}")()
        writer.Write()
surface = vtk.vtkGeometryFilter()
surface.SetInputData(grid)
writer = vtk.vtkPolyDataWriter()
writer.SetInputConnection(surface.GetOutputPort())
writer.SetFileName("vtk_polydata.vtk")
writer.SetFileTypeToBinary()
writer.Write()
