// Everything a user of the engine needs: shapes, deformations, parts, joints, bodies, simulations. Meshes of
// surfaces and insides included; scenes, files and pictures are libraries of their own (pliant/scene,
// pliant/io, pliant/render).
#pragma once

#include <pliant/body/joints/all_joints.h>
#include <pliant/deform/all_deforms.h>
#include <pliant/integrate/simulation.h>
#include <pliant/part/local_laws.h>
#include <pliant/part/registry.h>
#include <pliant/part/solid.h>
#include <pliant/part/surface.h>
#include <pliant/shape/all_shapes.h>
