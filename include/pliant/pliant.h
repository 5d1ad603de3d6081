// Everything a user of the engine needs: shapes, deformations, parts, joints, bodies, simulations. Meshes of
// surfaces and insides included; scenes, files and pictures are libraries of their own (pliant/scene,
// pliant/io, pliant/render).
#pragma once

#include <pliant/body/joints/all_joints.h>
#include <pliant/deform/all_deforms.h>
#include <pliant/part/local/local_laws.h>
#include <pliant/part/mesh/solid.h>
#include <pliant/part/mesh/surface.h>
#include <pliant/part/registry.h>
#include <pliant/shape/all_shapes.h>
#include <pliant/simulate/simulation.h>
