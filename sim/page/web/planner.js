"use strict";
class PlannerScene { }
