// Includes the headers of the engine for programs: shapes, deformations, parts, joints, bodies, simulations,
// and meshes of surfaces and solids. Scenes, files and pictures are in other libraries, with headers in
// pliant/scene, pliant/io and pliant/render.
#pragma once

#include <pliant/body/joints/all_joints.h>
#include <pliant/deform/all_deforms.h>
#include <pliant/part/local/local_laws.h>
#include <pliant/part/mesh/solid.h>
#include <pliant/part/mesh/surface.h>
#include <pliant/part/registry.h>
#include <pliant/shape/all_shapes.h>
#include <pliant/simulate/simulation.h>
