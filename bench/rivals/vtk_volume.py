"""VTK's volume mappers on the scene that `brace bench raycast` writes: the same voxels, camera, step, picture size
and transfer functions. Not part of Brace: runs where Debian's python3-vtk9 is installed.

    vtk_volume.py SCENE.json gpu|cpu

Prints one JSON object per line: {"renderer", "transfer", "median_ms", "min_ms", "cpu_min_ms"}; a line with "error"
says why there is nothing to measure.
"""
import json
import math
import os
import statistics
import sys
import time


def make_image(vtk, scene):
    reader = vtk.vtkImageReader2()
    reader.SetFileName(scene["voxels"])
    reader.SetFileDimensionality(3)
    reader.SetDataScalarTypeToUnsignedChar()
    edge = scene["edge"]
    reader.SetDataExtent(0, edge - 1, 0, edge - 1, 0, edge - 1)
    reader.FileLowerLeftOn()  # y as in the file
    reader.SetDataSpacing(1, 1, 1)
    reader.Update()
    return reader.GetOutput()


def make_property(vtk, points):
    """Opacity per voxel length, colours not premultiplied, no shading."""
    colour = vtk.vtkColorTransferFunction()
    opacity = vtk.vtkPiecewiseFunction()
    for value, r, g, b, kappa in points:
        colour.AddRGBPoint(value, r, g, b)
        opacity.AddPoint(value, 1.0 - math.exp(-kappa))
    prop = vtk.vtkVolumeProperty()
    prop.SetColor(colour)
    prop.SetScalarOpacity(opacity)
    prop.SetScalarOpacityUnitDistance(1.0)
    prop.SetInterpolationTypeToLinear()
    prop.ShadeOff()
    return prop


def make_mapper(vtk, kind, threads, step):
    if kind == "gpu":
        mapper = vtk.vtkGPUVolumeRayCastMapper()
        mapper.UseJitteringOff()
        mapper.LockSampleDistanceToInputSpacingOff()
    else:
        mapper = vtk.vtkFixedPointVolumeRayCastMapper()
        mapper.SetNumberOfThreads(threads)
        mapper.LockSampleDistanceToInputSpacingOff()
        mapper.SetInteractiveSampleDistance(step)
    mapper.SetAutoAdjustSampleDistances(0)
    mapper.SetSampleDistance(step)
    mapper.SetImageSampleDistance(1.0)
    return mapper


def make_window(vtk, scene, mapper, prop):
    volume = vtk.vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(prop)
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(0, 0, 0)
    renderer.AddVolume(volume)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(*scene["eye"])
    camera.SetFocalPoint(*[e + f for e, f in zip(scene["eye"], scene["forward"])])
    camera.SetViewUp(*scene["up"])
    camera.SetViewAngle(scene["fov_deg"])
    renderer.ResetCameraClippingRange()
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(scene["width_px"], scene["height_px"])
    window.AddRenderer(renderer)
    return window


def save(vtk, window, path):
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(path)
    writer.SetInputConnection(grab.GetOutputPort())
    writer.Write()


def measure(vtk, scene, image, kind, threads, transfer):
    mapper = make_mapper(vtk, kind, threads, scene["step_voxels"])
    mapper.SetInputData(image)
    window = make_window(vtk, scene, mapper, make_property(vtk, transfer["points"]))
    wall, cpu = [], []
    for i in range(scene["repetitions"] + 2):  # two to warm up: upload, shader compilation
        wall_start, cpu_start = time.perf_counter(), time.process_time()
        window.Render()
        window.WaitForCompletion()
        if i >= 2:
            wall.append(1e3 * (time.perf_counter() - wall_start))
            cpu.append(1e3 * (time.process_time() - cpu_start))
    name = "VTK GPU mapper" if kind == "gpu" else f"VTK fixed-point mapper, {threads} thread" + "s" * (threads > 1)
    if kind == "gpu":
        renderer = [line.split(":", 1)[1].strip() for line in window.ReportCapabilities().splitlines()
                    if line.startswith("OpenGL renderer string")]
        name += " on " + (renderer[0].split(" (")[0] if renderer else "an unknown OpenGL")
    if os.environ.get("BRACE_BENCH_PICTURES"):
        save(vtk, window, os.path.join(os.environ["BRACE_BENCH_PICTURES"], f"vtk_{kind}_{transfer['name']}.png"))
    print(json.dumps({"renderer": name, "transfer": transfer["name"], "median_ms": statistics.median(wall),
                      "min_ms": min(wall), "cpu_min_ms": min(cpu)}), flush=True)


def main():
    try:
        import vtk
    except ImportError as error:
        print(json.dumps({"error": f"VTK is not installed ({error}); apt install python3-vtk9 xvfb"}))
        return
    with open(sys.argv[1], encoding="utf-8") as file:
        scene = json.load(file)
    kind = sys.argv[2]
    image = make_image(vtk, scene)
    for threads in [0] if kind == "gpu" else [1, 2]:
        for transfer in scene["transfers"]:
            measure(vtk, scene, image, kind, threads, transfer)


main()
