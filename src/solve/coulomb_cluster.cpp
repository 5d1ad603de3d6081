// Compiles the functions of coulomb_cluster.h once for the library.
#include <pliant/solve/coulomb_cluster-inl.h>
