#include "sim/missions/mission_log.h"

void mission_log_header(FILE *log)
{
    (void)fprintf(log,
                  "t_s,x_m,y_m,ref_x_m,ref_y_m,heading_rad,speed_m_s,turn_rate_rad_s,ref_speed_m_s,"
                  "ref_turn_rate_rad_s,pitch_deg,u_left_v,u_right_v,i_left_a,i_right_a,power_w,energy_j,segment\n");
}

static double power(const struct scenario *scenario, const struct mission_row *row)
{
    const double electronics = scenario_robot(scenario).electronics_power_w;

    if (scenario->energy == ENERGY_BATTERY) {
        return row->voltage_left * row->current_left + row->voltage_right * row->current_right + electronics;
    }
    return (row->voltage_left * row->voltage_left + row->voltage_right * row->voltage_right) /
               scenario->robot.motor.resistance_ohm +
           electronics;
}

void mission_log_row(FILE *log, const struct scenario *scenario, const struct mission_row *row)
{
    (void)fprintf(log, "%.3f,%.5f,%.5f,%.5f,%.5f,%.6f,%.5f,%.6f,%.5f,%.6f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%zu\n",
                  row->time, row->position.x, row->position.y, row->reference.x, row->reference.y, row->heading,
                  row->speed, row->turn_rate, row->reference_speed, row->reference_turn_rate, row->pitch_deg,
                  row->voltage_left, row->voltage_right, row->current_left, row->current_right, power(scenario, row),
                  row->energy, row->leg + 1);
}
