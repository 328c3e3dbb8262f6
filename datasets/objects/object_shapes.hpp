#pragma once

#include "datasets/furniture/furniture.hpp"

// Things for a table, upright around the origin; each draws its own size and shape.
namespace landmarkdb::datasets {

void add_figurine(Workshop shop);  // a person of clay: body, head, hat, arms, something in a hand
void add_animal(Workshop shop);    // four legs, a head with ears, a tail
void add_carton(Workshop shop);    // a box of three different edges
void add_milk_carton(Workshop shop);   // a gable on top and a cap on one side of it
void add_bottle(Workshop shop);        // a body of revolution
void add_spray_bottle(Workshop shop);  // a flat bottle with a trigger
void add_mug(Workshop shop);           // with a handle
void add_tool(Workshop shop);          // a drill: grip, body, chuck, battery
void add_train(Workshop shop);         // a toy locomotive

}  // namespace landmarkdb::datasets
